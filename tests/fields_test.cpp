#include "dem/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace dem {
namespace {

enum class Shape { kSquare, kDiamond };

struct Options {
  double decay = 0.5;
  double height = 10;
  int steps = 3;
  std::uint64_t seed = 1;
  bool fast = false;
  Shape shape = Shape::kSquare;
};

std::vector<Field> fields(Options& o) {
  return {{"decay", o.decay, {0, 1}, "", "what is left after a step"},
          {"height", o.height, {}, "m", "of the top"},
          {"steps", o.steps, {1, 9}, "", "how many"},
          {"seed", o.seed, "of the noise"},
          {"fast", o.fast, "or good"},
          {"shape", o.shape, {"square", "diamond"}, "of a step"}};
}

std::string refusal(Options& o, const std::string& name, const std::string& text) {
  try {
    apply({{name, text}}, fields(o));
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(Field, DescribesItself) {
  Options o;
  const auto list = fields(o);
  std::vector<std::string> types, ranges, texts;
  for (const auto& f : list) {
    types.push_back(f.type());
    ranges.push_back(f.range());
    texts.push_back(f.text());
  }
  EXPECT_THAT(types,
              testing::ElementsAre("number", "number", "integer", "integer", "boolean", "choice"));
  EXPECT_THAT(ranges, testing::ElementsAre("[0, 1]", "", "[1, 9]", ">= 0", "false | true",
                                           "square | diamond"));
  EXPECT_THAT(texts, testing::ElementsAre("0.5", "10", "3", "1", "false", "square"));
  EXPECT_EQ(list[1].unit(), "m");
  EXPECT_EQ(list[1].doc(), "of the top");
}

TEST(Field, HalfOpenRangesReadAsInequalities) {
  double x = 0;
  EXPECT_EQ(Field("x", x, {0, INFINITY}, "", "").range(), ">= 0");
  EXPECT_EQ(Field("x", x, {-INFINITY, 4}, "", "").range(), "<= 4");
}

TEST(Apply, SetsEachNamedField) {
  Options o;
  apply({{"decay", "0.25"},
         {"height", "-1e3"},
         {"steps", "9"},
         {"seed", "18446744073709551615"},
         {"fast", "true"},
         {"shape", "diamond"}},
        fields(o));
  EXPECT_EQ(o.decay, 0.25);
  EXPECT_EQ(o.height, -1000);
  EXPECT_EQ(o.steps, 9);
  EXPECT_EQ(o.seed, 18446744073709551615u);
  EXPECT_TRUE(o.fast);
  EXPECT_EQ(o.shape, Shape::kDiamond);
}

TEST(Apply, TheLastOfTwoSettingsHolds) {
  Options o;
  apply({{"steps", "2"}, {"steps", "4"}}, fields(o));
  EXPECT_EQ(o.steps, 4);
}

TEST(Field, TextIsWhatSetTakes) {
  Options a, b;
  a.decay = 1.0 / 3;
  a.height = 6.02e23;
  a.shape = Shape::kDiamond;
  auto to = fields(b);
  const auto from = fields(a);
  for (std::size_t i = 0; i < to.size(); ++i) to[i].set(from[i].text());
  EXPECT_EQ(b.decay, a.decay);
  EXPECT_EQ(b.height, a.height);
  EXPECT_EQ(b.shape, a.shape);
}

TEST(Apply, RefusesWithTheFactAndLeavesTheValue) {
  Options o;
  EXPECT_EQ(refusal(o, "decay", "1.5"), "decay = 1.5; must be a number in [0, 1]");
  EXPECT_EQ(refusal(o, "steps", "2.5"), "steps = 2.5; must be a whole number in [1, 9]");
  EXPECT_EQ(refusal(o, "seed", "-1"), "seed = -1; must be a whole number >= 0");
  EXPECT_EQ(refusal(o, "fast", "yes"), "fast = yes; must be one of false, true");
  EXPECT_EQ(refusal(o, "shape", "round"), "shape = round; must be one of square, diamond");
  for (const char* text : {"", " 1", "1 ", "0.1x", "nan", "abc"})
    EXPECT_NE(refusal(o, "decay", text), "nothing was thrown") << '"' << text << '"';
  EXPECT_EQ(refusal(o, "height", "nan"), "height = nan; must be a number");
  EXPECT_EQ(refusal(o, "pace", "1"),
            "unknown setting \"pace\"; must be one of decay, height, steps, seed, fast, shape");
  EXPECT_EQ(o.decay, 0.5);
  EXPECT_EQ(o.steps, 3);
  EXPECT_EQ(o.seed, 1u);
  EXPECT_FALSE(o.fast);
  EXPECT_EQ(o.shape, Shape::kSquare);
}

struct Wishes {
  std::string layer{};
  std::size_t cells = 5;
  double factor = 2;
  std::optional<double> nodata;
  std::optional<int> band;
  std::optional<std::size_t> least;
  std::optional<std::uint64_t> seed;
  std::optional<bool> nodes;
  std::optional<std::string> tile;
  std::optional<Shape> shape;
};

std::vector<Field> fields(Wishes& w) {
  return {{"layer", w.layer, "of the file"},
          {"cells", w.cells, {4, INFINITY}, "cells", "how many"},
          {"factor", w.factor, {1, 9, true}, "", "how fine"},
          {"nodata", w.nodata, {.or_nan = true}, "m", "means none"},
          {"band", w.band, {1, 9}, "", "of the file"},
          {"least", w.least, {0, INFINITY}, "", "of a hole"},
          {"seed", w.seed, "of the noise"},
          {"nodes", w.nodes, "or cells"},
          {"tile", w.tile, "of the file"},
          {"shape", w.shape, {"square", "diamond"}, "of a step"}};
}

template <class Options>
std::string refused(Options& o, const std::string& name, const std::string& text) {
  try {
    field(o, name).set(text);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(Field, HoldsTextNumbersOfCellsAndValuesThatMayBeUnset) {
  Wishes w;
  std::vector<std::string> types, ranges, texts;
  for (const auto& f : fields(w)) {
    types.push_back(f.type());
    ranges.push_back(f.range());
    texts.push_back(f.text());
  }
  EXPECT_THAT(types, testing::ElementsAre("text", "integer", "number", "number", "integer",
                                          "integer", "integer", "boolean", "text", "choice"));
  EXPECT_THAT(ranges, testing::ElementsAre("", ">= 4", "(1, 9]", "", "[1, 9]", ">= 0", ">= 0",
                                           "false | true", "", "square | diamond"));
  EXPECT_THAT(texts, testing::ElementsAre("", "5", "2", "", "", "", "", "", "", ""));
  check(fields(w));

  apply({{"layer", "a b"},
         {"cells", "18446744073709551615"},
         {"factor", "9"},
         {"nodata", "-9999"},
         {"band", "2"},
         {"least", "7"},
         {"seed", "18446744073709551615"},
         {"nodes", "false"},
         {"tile", "N36E008"},
         {"shape", "diamond"}},
        fields(w));
  EXPECT_EQ(w.layer, "a b");
  EXPECT_EQ(w.cells, std::numeric_limits<std::size_t>::max());
  EXPECT_EQ(w.factor, 9);
  EXPECT_EQ(w.nodata, -9999);
  EXPECT_EQ(w.band, 2);
  EXPECT_EQ(w.least, 7u);
  EXPECT_EQ(w.seed, 18446744073709551615u);
  EXPECT_EQ(w.nodes, false);
  EXPECT_EQ(w.tile, "N36E008");
  EXPECT_EQ(w.shape, Shape::kDiamond);

  Wishes same;
  auto to = fields(same);
  const auto from = fields(w);
  for (std::size_t i = 0; i < to.size(); ++i) to[i].set(from[i].text());
  EXPECT_EQ(same.nodata, w.nodata);
  EXPECT_EQ(same.nodes, w.nodes);
  EXPECT_EQ(same.shape, w.shape);
}

TEST(Field, EmptyTextUnsetsWhatMayBeUnset) {
  Wishes w{.nodata = 1,
           .band = 2,
           .least = 3,
           .seed = 4,
           .nodes = true,
           .tile = "a",
           .shape = Shape::kDiamond};
  for (const char* name : {"nodata", "band", "least", "seed", "nodes", "tile", "shape"})
    field(w, name).set("");
  EXPECT_FALSE(w.nodata || w.band || w.least || w.seed || w.nodes || w.tile || w.shape);
  EXPECT_EQ(refused(w, "cells", ""), "cells = ; must be a whole number >= 4");
}

TEST(Field, RefusesTheEndOfAnOpenIntervalAndKeepsTheValue) {
  Wishes w;
  w.band = 3;
  EXPECT_EQ(refused(w, "factor", "1"), "factor = 1; must be a number in (1, 9]");
  EXPECT_EQ(refused(w, "cells", "3"), "cells = 3; must be a whole number >= 4");
  EXPECT_EQ(refused(w, "cells", "-5"), "cells = -5; must be a whole number >= 4");
  EXPECT_EQ(refused(w, "band", "10"), "band = 10; must be a whole number in [1, 9]");
  EXPECT_EQ(refused(w, "nodes", "yes"), "nodes = yes; must be one of false, true");
  EXPECT_EQ(refused(w, "shape", "round"), "shape = round; must be one of square, diamond");
  EXPECT_EQ(w.band, 3);
  w.band = 10;
  EXPECT_THROW(check(fields(w)), std::invalid_argument);
}

TEST(Field, NanIsAValueOnlyWhereTheRangeSaysSo) {
  Wishes w;
  field(w, "nodata").set("nan");
  EXPECT_TRUE(w.nodata && std::isnan(*w.nodata));
  check(fields(w));
  w.factor = std::nan("");
  EXPECT_THROW(check(fields(w)), std::invalid_argument);
}

TEST(Check, FindsValuesSetBesideTheFields) {
  Options o;
  check(fields(o));
  o.decay = std::nan("");
  EXPECT_THROW(check(fields(o)), std::invalid_argument);
  o.decay = 1;
  o.steps = 10;
  EXPECT_THROW(check(fields(o)), std::invalid_argument);
  o.steps = 1;
  o.shape = Shape(2);
  EXPECT_THROW(check(fields(o)), std::invalid_argument);
}

}  // namespace
}  // namespace dem
