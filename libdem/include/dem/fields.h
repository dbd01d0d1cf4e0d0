#pragma once
// A method describes its options once, as a list of fields beside its Options struct:
//
//   std::vector<Field> fields(McmdOptions& o) {
//     return {{"I", o.I, {-50, 50}, "", "bend of the top-down mean; 0: a plain mean"}, ...};
//   }
//
// Command line, reports, tests and benchmarks loop over that list; nobody retypes a default.

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dem {

/// The interval [min, max] that a number must lie in.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< min itself lies outside: (min, max]
  bool or_nan = false;     ///< NaN is a value too, as it is for nodata
};

/// One option of one Options object: its description, and access to its value as text.
/// It refers to the object it was made from, which must outlive it.
/// A std::optional has the type of its value. While it is unset its text is "", and set("") unsets
/// it.
class Field {
 public:
  /// A number: T is double, int, std::size_t, or a std::optional of one of them.
  template <class T>
  Field(std::string name, T& value, Range range, std::string unit, std::string doc);

  /// T is bool, std::uint64_t, std::string, or a std::optional of one of them.
  template <class T>
  Field(std::string name, T& value, std::string doc);

  /// An enum whose enumerators 0, 1, 2, ... are called `choices[0]`, `choices[1]`, ...
  template <class Enum>
  Field(std::string name, Enum& value, std::vector<std::string> choices, std::string doc)
      : Field(std::move(name), std::move(choices), std::move(doc),
              {[&value] { return static_cast<int>(value); },
               [&value](int i) { value = static_cast<Enum>(i); }, false}) {}

  template <class Enum>
  Field(std::string name, std::optional<Enum>& value, std::vector<std::string> choices,
        std::string doc)
      : Field(std::move(name), std::move(choices), std::move(doc),
              {[&value] { return value ? static_cast<int>(*value) : kUnset; },
               [&value](int i) {
                 if (i == kUnset)
                   value.reset();
                 else
                   value = static_cast<Enum>(i);
               },
               true}) {}

  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  const std::string& doc() const { return doc_; }
  const std::vector<std::string>& choices() const { return choices_; }

  const std::string& type() const {
    return type_;
  }                           ///< "number", "integer", "boolean", "choice", "text"
  std::string range() const;  ///< "[0, 1]", "(0, 1]", "> 0", "a | b", "" when anything goes
  std::string text() const;   ///< the value, in the form that set() takes; "" while it is unset

  /// Throws std::invalid_argument `name = text; must be ...` and leaves the value as it was.
  void set(std::string_view text);

  /// Throws std::invalid_argument when the value lies outside the range or is not a number.
  void check() const;

 private:
  static constexpr int kUnset = -1;

  /// How the number of a choice is read and written.
  struct Choice {
    std::function<int()> get;
    std::function<void(int)> set;
    bool may_be_unset;
  };
  Field(std::string name, std::vector<std::string> choices, std::string doc, Choice choice);

  /// What a field does with its value, whatever its type.
  struct Access {
    std::function<std::string()> text;
    std::function<bool(std::string_view)> set;  ///< false: refused, and nothing was changed
    std::function<bool()> good;                 ///< whether the value may be as it is
  };
  template <class T>
  static Access access(T& value, Range range);

  [[noreturn]] void refuse(std::string_view text) const;

  std::string name_, type_, unit_, doc_;
  std::vector<std::string> choices_;
  Range range_;
  Access access_;
};

/// Settings as text, in the order given: {{"I", "0.4"}, {"seed", "7"}}.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Sets each named field. Throws std::invalid_argument for a name that is not among them.
void apply(const Settings& settings, std::vector<Field> fields);

/// The field called `name`. Throws std::invalid_argument when there is none.
Field find_field(std::vector<Field> fields, std::string_view name);

/// The field of an Options object that is called `name`.
template <class Options>
Field field(Options& options, std::string_view name) {
  return find_field(fields(options), name);
}

/// Checks every field.
void check(const std::vector<Field>& fields);

/// Checks every field of an Options object.
template <class Options>
void check_options(Options options) {
  check(fields(options));
}

}  // namespace dem
