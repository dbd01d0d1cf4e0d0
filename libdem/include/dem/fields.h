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
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace dem {

/// The closed interval [min, max] that a number must lie in.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// One option of one Options object: its description, and access to its value as text.
/// It refers to the object it was made from, which must outlive it.
class Field {
 public:
  Field(std::string name, double& value, Range range, std::string unit, std::string doc);
  Field(std::string name, int& value, Range range, std::string unit, std::string doc);
  Field(std::string name, std::uint64_t& value, std::string doc);
  Field(std::string name, bool& value, std::string doc);

  /// An enum whose enumerators 0, 1, 2, ... are called `choices[0]`, `choices[1]`, ...
  template <class Enum>
  Field(std::string name, Enum& value, std::vector<std::string> choices, std::string doc)
      : name_(std::move(name)),
        doc_(std::move(doc)),
        choices_(std::move(choices)),
        value_(Choice{[&value] { return static_cast<int>(value); },
                      [&value](int i) { value = static_cast<Enum>(i); }}) {}

  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  const std::string& doc() const { return doc_; }
  const std::vector<std::string>& choices() const { return choices_; }

  std::string type() const;   ///< "number", "integer", "boolean" or "choice"
  std::string range() const;  ///< "[0, 1]", "a | b", "" when anything goes
  std::string text() const;   ///< the value, in the form that set() takes

  /// Throws std::invalid_argument `name = text; must be ...` and leaves the value as it was.
  void set(std::string_view text);

  /// Throws std::invalid_argument when the value lies outside the range or is not a number.
  void check() const;

 private:
  struct Choice {
    std::function<int()> get;
    std::function<void(int)> set;
  };

  [[noreturn]] void refuse(std::string_view text) const;

  std::string name_, unit_, doc_;
  std::vector<std::string> choices_;
  Range range_;
  std::variant<double*, int*, std::uint64_t*, bool*, Choice> value_;
};

/// Settings as text, in the order given: {{"I", "0.4"}, {"seed", "7"}}.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Sets each named field. Throws std::invalid_argument for a name that is not among them.
void apply(const Settings& settings, std::vector<Field> fields);

/// Checks every field.
void check(const std::vector<Field>& fields);

/// Checks every field of an Options object.
template <class Options>
void check_options(Options options) {
  check(fields(options));
}

}  // namespace dem
