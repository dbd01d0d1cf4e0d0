#include "dem/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace dem {
namespace {

/// The whole of `text` as a number of type T, or false.
template <class T>
bool parse(std::string_view text, T& out) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  out = value;
  return true;
}

bool inside(double value, Range range) { return value >= range.min && value <= range.max; }

std::string join(const std::vector<std::string>& words, std::string_view separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

}  // namespace

Field::Field(std::string name, double& value, Range range, std::string unit, std::string doc)
    : name_(std::move(name)),
      unit_(std::move(unit)),
      doc_(std::move(doc)),
      range_(range),
      value_(&value) {}

Field::Field(std::string name, int& value, Range range, std::string unit, std::string doc)
    : name_(std::move(name)),
      unit_(std::move(unit)),
      doc_(std::move(doc)),
      range_(range),
      value_(&value) {}

Field::Field(std::string name, std::uint64_t& value, std::string doc)
    : name_(std::move(name)), doc_(std::move(doc)), value_(&value) {}

Field::Field(std::string name, bool& value, std::string doc)
    : name_(std::move(name)), doc_(std::move(doc)), choices_{"false", "true"}, value_(&value) {}

std::string Field::type() const {
  if (std::holds_alternative<double*>(value_)) return "number";
  if (std::holds_alternative<bool*>(value_)) return "boolean";
  return std::holds_alternative<Choice>(value_) ? "choice" : "integer";
}

std::string Field::range() const {
  if (!choices_.empty()) return join(choices_, " | ");
  if (std::holds_alternative<std::uint64_t*>(value_)) return ">= 0";
  const bool below = std::isfinite(range_.min), above = std::isfinite(range_.max);
  if (below && above) return fmt::format("[{}, {}]", range_.min, range_.max);
  if (below) return fmt::format(">= {}", range_.min);
  return above ? fmt::format("<= {}", range_.max) : "";
}

std::string Field::text() const {
  if (auto* v = std::get_if<double*>(&value_)) return fmt::format("{}", **v);
  if (auto* v = std::get_if<int*>(&value_)) return fmt::format("{}", **v);
  if (auto* v = std::get_if<std::uint64_t*>(&value_)) return fmt::format("{}", **v);
  if (auto* v = std::get_if<bool*>(&value_)) return **v ? "true" : "false";
  return choices_.at(std::size_t(std::get<Choice>(value_).get()));
}

void Field::refuse(std::string_view text) const {
  std::string what = type() == "integer" ? "a whole number" : "a number";
  if (!choices_.empty())
    what = "one of " + join(choices_, ", ");
  else if (!range().empty())
    what += range()[0] == '[' ? " in " + range() : " " + range();
  throw std::invalid_argument(fmt::format("{} = {}; must be {}", name_, text, what));
}

void Field::set(std::string_view text) {
  if (!choices_.empty()) {
    const auto found = std::ranges::find(choices_, text);
    if (found == choices_.end()) refuse(text);
    const int i = int(found - choices_.begin());
    if (auto* v = std::get_if<bool*>(&value_))
      **v = i == 1;
    else
      std::get<Choice>(value_).set(i);
  } else if (auto* d = std::get_if<double*>(&value_)) {
    double value = 0;
    if (!parse(text, value) || !inside(value, range_)) refuse(text);
    **d = value;
  } else if (auto* i = std::get_if<int*>(&value_)) {
    int value = 0;
    if (!parse(text, value) || !inside(value, range_)) refuse(text);
    **i = value;
  } else if (!parse(text, *std::get<std::uint64_t*>(value_))) {
    refuse(text);
  }
}

void Field::check() const {
  if (auto* d = std::get_if<double*>(&value_)) {
    if (!inside(**d, range_)) refuse(text());
  } else if (auto* i = std::get_if<int*>(&value_)) {
    if (!inside(**i, range_)) refuse(text());
  } else if (auto* c = std::get_if<Choice>(&value_)) {
    const int at = c->get();
    if (at < 0 || at >= int(choices_.size())) refuse(fmt::format("{}", at));
  }
}

void apply(const Settings& settings, std::vector<Field> fields) {
  for (const auto& [name, text] : settings) {
    const auto field = std::ranges::find(fields, name, &Field::name);
    if (field == fields.end()) {
      std::vector<std::string> names;
      for (const auto& f : fields) names.push_back(f.name());
      throw std::invalid_argument(
          fmt::format("unknown setting \"{}\"; must be one of {}", name, join(names, ", ")));
    }
    field->set(text);
  }
}

void check(const std::vector<Field>& fields) {
  for (const auto& field : fields) field.check();
}

}  // namespace dem
