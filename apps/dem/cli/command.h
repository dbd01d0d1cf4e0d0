#pragma once
// The command line as data: verbs, and options that are bound to variables. The parser, the help,
// the manual pages and the completion of shells all read it.

#include <charconv>
#include <concepts>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "dem/fields.h"

namespace dem::app {

/// Throws std::invalid_argument `option = text; must be ...`.
[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view must_be);

/// The whole of `text` as a value; false when it is none. Numbers are finite.
bool read_value(const std::string& text, std::string& value);
bool read_value(const std::string& text, double& value);
template <std::integral T>
bool read_value(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}
template <class T>
bool read_value(const std::string& text, std::optional<T>& value) {
  return read_value(text, value.emplace());
}
template <class T>
bool read_value(const std::string& text, std::vector<T>& values) {
  return read_value(text, values.emplace_back());
}

std::string text_of(const std::string& value);
std::string text_of(double value);
template <std::integral T>
std::string text_of(T value) {
  return std::to_string(value);
}
template <class T>
std::string text_of(const std::optional<T>& value) {
  return value ? text_of(*value) : "";
}
template <class T>
std::string text_of(const std::vector<T>& values) {
  std::string text;
  for (const T& value : values) {
    if (!text.empty()) text += ',';
    text += text_of(value);
  }
  return text;
}

/// An option, or an argument by position. The setters return the option, so that they can be
/// chained.
class Option {
 public:
  std::vector<std::string> names;    ///< {"-m", "--method"}; by position: {"IN"}
  std::string value;                 ///< what stands for its value in the help, "NAME"; "": none
  std::string doc;                   ///< one line
  std::string group;                 ///< heading in the help
  std::string default_text;          ///< "" when there is none to show
  std::string takes;                 ///< kind of value, see kind(); "": any text
  std::vector<std::string> choices;  ///< the values that there are, or the usual ones
  bool required = false, repeats = false;
  int count = 0;  ///< how often it was given

  bool by_position() const { return !names.front().starts_with('-'); }
  bool is_switch() const { return !by_position() && value.empty(); }
  const std::string& name() const { return names.back(); }  ///< "--method" or "IN"

  /// The value is a number, crs, raster, vector, points, file or folder, or it is written: "new
  /// raster", "new vector", "new picture", "new file", "new folder".
  Option& kind(std::string what);
  Option& one_of(std::vector<std::string> names_of_values);   ///< any other value is refused
  Option& suggest(std::vector<std::string> names_of_values);  ///< whoever reads them refuses
  Option& within(double low, double high);                    ///< the closed interval of a number
  Option& above(double low);                                  ///< a number above it
  Option& by_commas();                                        ///< several values in one text
  Option& must_be_given();
  Option& show_default();  ///< what its variable holds now, in the help
  Option& show_default(std::string text);

  /// Reads a value into the variable; throws std::invalid_argument that names the option.
  void accept(const std::string& text);

 private:
  friend class Command;
  enum class Type { text, number, whole };

  template <class T>
  void bind(T& variable) {
    set_ = [&variable, first = true](const std::string& text) mutable {
      [[maybe_unused]] const bool was_first = std::exchange(first, false);
      if constexpr (requires { variable.emplace_back(); })
        if (was_first) variable.clear();  // what it held was the default
      return read_value(text, variable);
    };
    now_ = [&variable] { return text_of(variable); };
    repeats = requires { variable.emplace_back(); };
    bind_type<T>();
  }
  template <class T>
  void bind_type() {
    if constexpr (std::integral<T>)
      type_ = Type::whole, low_ = std::is_unsigned_v<T> ? 0 : low_;
    else if constexpr (std::floating_point<T>)
      type_ = Type::number;
    else if constexpr (!std::is_same_v<T, std::string> && requires { typename T::value_type; })
      bind_type<typename T::value_type>();
    if (type_ != Type::text) takes = "number";
  }
  void accept_one(const std::string& text);
  std::string must_be() const;

  std::function<bool(const std::string&)> set_;  // false: the text is no such value
  std::function<std::string()> now_;
  Type type_ = Type::text;
  double low_ = -std::numeric_limits<double>::infinity();
  double high_ = std::numeric_limits<double>::infinity();
  bool closed_ = false, low_excluded_ = false, commas_ = false;
};

/// A verb of the program.
class Command {
 public:
  std::string name, summary;
  std::string group;     ///< heading of the verb in the help of the program
  std::string examples;  ///< lines that begin with two spaces
  std::string notes;     ///< lines below the examples
  std::function<int()> work;
  std::deque<Option> arguments, options;

  /// Options that are added from here on stand under this heading.
  void heading(std::string text) { heading_ = std::move(text); }

  template <class T>
  Option& argument(std::string name_of_it, T& variable, std::string doc) {
    Option& added = add(arguments, std::move(name_of_it), "", std::move(doc));
    added.group = "Positionals";
    added.bind(variable);
    return added;
  }

  /// `names`: "--sigma" or "-m,--method". `variable`: std::string, a number, std::optional of
  /// these, or std::vector of these (then the option may be repeated).
  template <class T>
  Option& option(const std::string& names, T& variable, std::string value, std::string doc) {
    Option& added = add(options, names, std::move(value), std::move(doc));
    added.bind(variable);
    return added;
  }

  /// `read` throws std::invalid_argument that names the option.
  Option& option_read_by(const std::string& names, std::function<void(const std::string&)> read,
                         std::string value, std::string doc);

  Option& flag(const std::string& names, bool& variable, std::string doc);
  Option& flag_that(const std::string& names, std::function<void()> act, std::string doc);

  /// The option that is called so, "-m" or "--method"; null when there is none.
  Option* find(std::string_view option_name);

  std::string synopsis() const;             ///< "dem fill [OPTIONS] IN OUT"
  std::vector<std::string> groups() const;  ///< of the options, in the order in which they come

 private:
  Option& add(std::deque<Option>& where, const std::string& names, std::string value,
              std::string doc);

  std::string heading_ = "Options";
};

/// Options of the fields: --name for each (- for _), with its doc, range, choices and default. A
/// boolean that is true becomes --no-name.
void add_fields(Command& command, const std::vector<Field>& fields);

/// All verbs.
struct Program {
  std::string summary, examples, notes;
  std::deque<Command> commands;

  Command& add(std::string name, std::string group, std::string summary, std::string examples);

  /// Throws std::invalid_argument that lists the verbs.
  const Command& find(const std::string& name) const;
  std::vector<std::string> names() const;
  std::vector<std::string> groups() const;  ///< of the verbs, in the order in which they come
};

}  // namespace dem::app
