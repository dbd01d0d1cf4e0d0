#include "dem/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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
