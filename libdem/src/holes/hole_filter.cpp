// Conditions on holes, written as text:
//
//   any    = all { "or" all }
//   all    = one { "and" one }
//   one    = "not" one | sum [ ("<" | "<=" | ">" | ">=" | "=" | "==" | "!=") sum ]
//   sum    = term { ("+" | "-") term }
//   term   = factor { ("*" | "/") factor }
//   factor = number | name | "-" factor | "(" any ")"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <stdexcept>

#include "dem/holes.h"

namespace dem {
namespace {

using Value = std::function<double(const Hole&)>;

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Value whole() {
    Value value = any();
    if (skip_blanks() < text_.size()) fail("an operator");
    return value;
  }

 private:
  static constexpr int deepest = 64;

  [[noreturn]] void fail(std::string_view expected) {
    skip_blanks();
    const std::string found =
        at_ < text_.size() ? fmt::format("\"{}\"", text_.substr(at_, 12)) : "the end";
    throw std::invalid_argument(
        fmt::format("where = {}; must have {} at {}", text_, expected, found));
  }

  std::size_t skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_;
  }

  static bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

  /// Takes a sign or a whole word, if it comes next.
  bool take(std::string_view token) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(token)) return false;
    const std::size_t end = at_ + token.size();
    if (in_name(token.back()) && end < text_.size() && in_name(text_[end])) return false;
    at_ = end;
    return true;
  }

  Value any() {
    Value left = all();
    while (take("or"))
      left = [left, right = all()](const Hole& h) { return left(h) != 0 || right(h) != 0; };
    return left;
  }

  Value all() {
    Value left = one();
    while (take("and"))
      left = [left, right = one()](const Hole& h) { return left(h) != 0 && right(h) != 0; };
    return left;
  }

  Value one() {
    if (take("not")) {
      enter();
      Value value = one();
      --depth_;
      return [value](const Hole& h) { return value(h) == 0; };
    }
    Value left = sum();
    const auto compared = [&](auto compare) -> Value {
      return [left, right = sum(), compare](const Hole& h) -> double {
        return compare(left(h), right(h));
      };
    };
    if (take("<=")) return compared([](double a, double b) { return a <= b; });
    if (take(">=")) return compared([](double a, double b) { return a >= b; });
    if (take("!=")) return compared([](double a, double b) { return a != b; });
    if (take("==") || take("=")) return compared([](double a, double b) { return a == b; });
    if (take("<")) return compared([](double a, double b) { return a < b; });
    if (take(">")) return compared([](double a, double b) { return a > b; });
    return left;
  }

  Value sum() {
    Value left = term();
    while (true) {
      if (take("+"))
        left = [left, right = term()](const Hole& h) { return left(h) + right(h); };
      else if (take("-"))
        left = [left, right = term()](const Hole& h) { return left(h) - right(h); };
      else
        return left;
    }
  }

  Value term() {
    Value left = factor();
    while (true) {
      if (take("*"))
        left = [left, right = factor()](const Hole& h) { return left(h) * right(h); };
      else if (take("/"))
        left = [left, right = factor()](const Hole& h) { return left(h) / right(h); };
      else
        return left;
    }
  }

  Value factor() {
    enter();
    Value value = unary();
    --depth_;
    return value;
  }

  Value unary() {
    if (take("-")) return [value = factor()](const Hole& h) { return -value(h); };
    if (take("(")) {
      Value value = any();
      if (!take(")")) fail("a closing bracket");
      return value;
    }
    skip_blanks();
    double number = 0;
    const char* const begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), number);
    if (at_ < text_.size() && !std::isalpha(static_cast<unsigned char>(*begin)) &&
        error == std::errc()) {
      at_ += std::size_t(end - begin);
      return [number](const Hole&) { return number; };
    }
    std::size_t length = 0;
    while (at_ + length < text_.size() && in_name(text_[at_ + length])) ++length;
    for (const HoleFact& fact : hole_facts())
      if (fact.name == text_.substr(at_, length)) {
        at_ += length;
        return fact.value;
      }
    std::string names;
    for (const HoleFact& fact : hole_facts()) names += (names.empty() ? "" : ", ") + fact.name;
    fail("a number or one of " + names);
  }

  void enter() {
    if (++depth_ > deepest) fail(fmt::format("at most {} brackets and signs in a row", deepest));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

const std::vector<HoleFact>& hole_facts() {
  static const std::vector<HoleFact> facts{
      {"cells", "unknown cells", [](const Hole& h) { return double(h.cells); }},
      {"area_km2", "their area on the ground", [](const Hole& h) { return h.area_m2 / 1e6; }},
      {"distance_m", "greatest distance to data", [](const Hole& h) { return h.distance_m; }},
      {"rim_relief_m", "highest less lowest known cell beside it",
       [](const Hole& h) { return h.rim_relief_m(); }},
      {"rim_low_m", "lowest known cell beside it", [](const Hole& h) { return h.rim_low_m; }},
      {"rim_high_m", "highest", [](const Hole& h) { return h.rim_high_m; }},
      {"rim_mean_m", "mean height of the rim", [](const Hole& h) { return h.rim_mean_m; }},
      {"at_border", "1 if it touches the raster's border",
       [](const Hole& h) { return double(h.at_border); }},
      {"col", "first column of its box", [](const Hole& h) { return double(h.box.col); }},
      {"row", "first row of its box", [](const Hole& h) { return double(h.box.row); }},
      {"cols", "columns of its box", [](const Hole& h) { return double(h.box.cols); }},
      {"rows", "rows of its box", [](const Hole& h) { return double(h.box.rows); }},
  };
  return facts;
}

std::function<bool(const Hole&)> parse_hole_filter(std::string_view text) {
  return [value = Parser(text).whole()](const Hole& hole) { return value(hole) != 0; };
}

}  // namespace dem
