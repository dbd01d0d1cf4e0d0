#include "dem/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <type_traits>

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

bool parse(std::string_view text, std::string& out) {
  out = text;
  return true;
}

bool parse(std::string_view text, bool& out) {
  out = text == "true";
  return out || text == "false";
}

bool inside(double value, Range range) {
  if (std::isnan(value)) return range.or_nan;
  return value <= range.max && (range.above_min ? value > range.min : value >= range.min);
}

template <class T>
bool is_good(const T& value, Range range) {
  if constexpr (std::is_same_v<T, std::string>)
    return true;
  else
    return inside(double(value), range);
}

template <class T>
constexpr bool is_optional = false;
template <class T>
constexpr bool is_optional<std::optional<T>> = true;

/// The type of what an option holds.
template <class T>
struct Held {
  using type = T;
};
template <class T>
struct Held<std::optional<T>> {
  using type = T;
};

template <class T>
const char* type_name() {
  using Value = typename Held<T>::type;
  if (std::is_same_v<Value, bool>) return "boolean";
  if (std::is_same_v<Value, std::string>) return "text";
  return std::is_floating_point_v<Value> ? "number" : "integer";
}

/// The range of a value that needs none to be given: an unsigned number tells its own.
template <class T>
Range own_range() {
  return std::is_same_v<typename Held<T>::type, std::uint64_t> ? Range{.min = 0} : Range{};
}

template <class T>
std::vector<std::string> own_choices() {
  using Value = typename Held<T>::type;
  if (std::is_same_v<Value, bool>) return {"false", "true"};
  return {};
}

std::string join(const std::vector<std::string>& words, std::string_view separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

}  // namespace

template <class T>
Field::Access Field::access(T& value, Range range) {
  if constexpr (is_optional<T>) {
    using Value = typename T::value_type;
    return {[&value] { return value ? fmt::format("{}", *value) : std::string(); },
            [&value, range](std::string_view text) {
              Value read{};
              if (!text.empty() && (!parse(text, read) || !is_good(read, range))) return false;
              if (text.empty())
                value.reset();
              else
                value = std::move(read);
              return true;
            },
            [&value, range] { return !value || is_good(*value, range); }};
  } else {
    return {[&value] { return fmt::format("{}", value); },
            [&value, range](std::string_view text) {
              T read{};
              if (!parse(text, read) || !is_good(read, range)) return false;
              value = std::move(read);
              return true;
            },
            [&value, range] { return is_good(value, range); }};
  }
}

template <class T>
Field::Field(std::string name, T& value, Range range, std::string unit, std::string doc)
    : name_(std::move(name)),
      type_(type_name<T>()),
      unit_(std::move(unit)),
      doc_(std::move(doc)),
      range_(range),
      access_(access(value, range)) {}
template Field::Field(std::string, double&, Range, std::string, std::string);
template Field::Field(std::string, int&, Range, std::string, std::string);
template Field::Field(std::string, std::size_t&, Range, std::string, std::string);
template Field::Field(std::string, std::optional<double>&, Range, std::string, std::string);
template Field::Field(std::string, std::optional<int>&, Range, std::string, std::string);
template Field::Field(std::string, std::optional<std::size_t>&, Range, std::string, std::string);

template <class T>
Field::Field(std::string name, T& value, std::string doc)
    : name_(std::move(name)),
      type_(type_name<T>()),
      doc_(std::move(doc)),
      choices_(own_choices<T>()),
      range_(own_range<T>()),
      access_(access(value, range_)) {}
template Field::Field(std::string, bool&, std::string);
template Field::Field(std::string, std::uint64_t&, std::string);
template Field::Field(std::string, std::string&, std::string);
template Field::Field(std::string, std::optional<bool>&, std::string);
template Field::Field(std::string, std::optional<std::uint64_t>&, std::string);
template Field::Field(std::string, std::optional<std::string>&, std::string);

Field::Field(std::string name, std::vector<std::string> choices, std::string doc, Choice choice)
    : name_(std::move(name)),
      type_("choice"),
      doc_(std::move(doc)),
      choices_(std::move(choices)),
      access_{[choice, names = choices_] {
                const int i = choice.get();
                if (i == kUnset && choice.may_be_unset) return std::string();
                return i >= 0 && i < int(names.size()) ? names[std::size_t(i)]
                                                       : fmt::format("{}", i);
              },
              [choice, names = choices_](std::string_view text) {
                const auto found = std::ranges::find(names, text);
                const bool unset = text.empty() && choice.may_be_unset;
                if (found == names.end() && !unset) return false;
                choice.set(unset ? kUnset : int(found - names.begin()));
                return true;
              },
              [choice, n = int(choices_.size())] {
                const int i = choice.get();
                return (i == kUnset && choice.may_be_unset) || (i >= 0 && i < n);
              }} {}

std::string Field::range() const {
  if (!choices_.empty()) return join(choices_, " | ");
  const char* const open = range_.above_min ? "(" : "[";
  const char* const more = range_.above_min ? ">" : ">=";
  const bool below = std::isfinite(range_.min), above = std::isfinite(range_.max);
  if (below && above) return fmt::format("{}{}, {}]", open, range_.min, range_.max);
  if (below) return fmt::format("{} {}", more, range_.min);
  return above ? fmt::format("<= {}", range_.max) : "";
}

std::string Field::text() const { return access_.text(); }

void Field::refuse(std::string_view text) const {
  std::string what = type_ == "integer" ? "a whole number" : "a number";
  if (!choices_.empty())
    what = "one of " + join(choices_, ", ");
  else if (!range().empty())
    what +=
        std::isfinite(range_.min) && std::isfinite(range_.max) ? " in " + range() : " " + range();
  throw std::invalid_argument(fmt::format("{} = {}; must be {}", name_, text, what));
}

void Field::set(std::string_view text) {
  if (!access_.set(text)) refuse(text);
}

void Field::check() const {
  if (!access_.good()) refuse(text());
}

Field find_field(std::vector<Field> fields, std::string_view name) {
  const auto found = std::ranges::find(fields, name, &Field::name);
  if (found != fields.end()) return std::move(*found);
  std::vector<std::string> names;
  for (const auto& f : fields) names.push_back(f.name());
  throw std::invalid_argument(
      fmt::format("unknown setting \"{}\"; must be one of {}", name, join(names, ", ")));
}

void apply(const Settings& settings, std::vector<Field> fields) {
  for (const auto& [name, text] : settings) find_field(fields, name).set(text);
}

void check(const std::vector<Field>& fields) {
  for (const auto& field : fields) field.check();
}

}  // namespace dem
