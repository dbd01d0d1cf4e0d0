#include "cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace dem::app {
namespace {

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

template <class Items>
std::vector<std::string> groups_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items)
    if (std::ranges::count(names, item.group) == 0) names.push_back(item.group);
  return names;
}

}  // namespace

void refuse(std::string_view option, std::string_view text, std::string_view must_be) {
  throw std::invalid_argument(fmt::format("{} = {}; must be {}", option, text, must_be));
}

bool read_value(const std::string& text, std::string& value) {
  value = text;
  return true;
}

bool read_value(const std::string& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

std::string text_of(const std::string& value) { return value; }
std::string text_of(double value) { return fmt::format("{}", value); }

// ---- Options

Option& Option::kind(std::string what) {
  takes = std::move(what);
  return *this;
}

Option& Option::one_of(std::vector<std::string> names_of_values) {
  closed_ = true;
  return suggest(std::move(names_of_values));
}

Option& Option::suggest(std::vector<std::string> names_of_values) {
  choices = std::move(names_of_values);
  return *this;
}

Option& Option::within(double low, double high) {
  low_ = low;
  high_ = high;
  return *this;
}

Option& Option::above(double low) {
  low_ = low;
  low_excluded_ = true;
  return *this;
}

Option& Option::by_commas() {
  commas_ = true;
  return *this;
}

Option& Option::must_be_given() {
  required = true;
  return *this;
}

Option& Option::show_default() { return show_default(now_()); }

Option& Option::show_default(std::string text) {
  default_text = std::move(text);
  return *this;
}

std::string Option::must_be() const {
  if (closed_) return fmt::format("one of {}", fmt::join(choices, ", "));
  std::string text = type_ == Type::whole ? "a whole number" : "a number";
  if (low_excluded_)
    text += fmt::format(" above {}", low_);
  else if (std::isfinite(low_) && std::isfinite(high_))
    text += fmt::format(" from {} to {}", low_, high_);
  else if (std::isfinite(low_))
    text += fmt::format(" from {} up", low_);
  return text;
}

void Option::accept(const std::string& text) {
  if (++count > 1 && !repeats && !is_switch())
    throw std::invalid_argument(fmt::format("{} is given more than once", name()));
  if (commas_)
    for (const std::string& part : split(text)) accept_one(part);
  else
    accept_one(text);
}

void Option::accept_one(const std::string& text) {
  if (closed_ && std::ranges::count(choices, text) == 0) refuse(name(), text, must_be());
  if (double v = 0; type_ != Type::text && read_value(text, v))
    if (v < low_ || v > high_ || (low_excluded_ && v <= low_)) refuse(name(), text, must_be());
  if (!set_(text)) refuse(name(), text, must_be());
}

// ---- Commands

Option& Command::add(std::deque<Option>& where, const std::string& names, std::string value,
                     std::string doc) {
  Option& added = where.emplace_back();
  added.names = split(names);
  added.value = std::move(value);
  added.doc = std::move(doc);
  added.group = heading_;
  return added;
}

Option& Command::option_read_by(const std::string& names,
                                std::function<void(const std::string&)> read, std::string value,
                                std::string doc) {
  Option& added = add(options, names, std::move(value), std::move(doc));
  added.set_ = [read = std::move(read)](const std::string& text) {
    read(text);
    return true;
  };
  added.now_ = [] { return std::string(); };
  return added;
}

Option& Command::flag(const std::string& names, bool& variable, std::string doc) {
  return flag_that(
      names, [&variable] { variable = true; }, std::move(doc));
}

Option& Command::flag_that(const std::string& names, std::function<void()> act, std::string doc) {
  return option_read_by(
      names, [act = std::move(act)](const std::string&) { act(); }, "", std::move(doc));
}

Option* Command::find(std::string_view option_name) {
  const auto called_so = [&](const Option& o) { return std::ranges::count(o.names, option_name); };
  const auto found = std::ranges::find_if(options, called_so);
  return found == options.end() ? nullptr : &*found;
}

std::string Command::synopsis() const {
  std::string text = "dem " + name + " [OPTIONS]";
  for (const Option& a : arguments) {
    const std::string words = a.name() + (a.repeats ? "..." : "");
    text += a.required ? " " + words : fmt::format(" [{}]", words);
  }
  return text;
}

std::vector<std::string> Command::groups() const { return groups_of(options); }

void add_fields(Command& command, const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    std::string option = "--" + field.name();
    std::ranges::replace(option, '_', '-');
    if (field.type() == "boolean") {
      const bool on = field.text() == "true";
      command.flag_that(
          on ? "--no-" + option.substr(2) : option,
          [copy = field, on]() mutable { copy.set(on ? "false" : "true"); }, field.doc());
      continue;
    }
    const bool number = field.type() == "number" || field.type() == "integer";
    const auto read = [option, copy = field](const std::string& text) mutable {
      try {
        copy.set(text);
      } catch (const std::invalid_argument& error) {  // it names the field
        const std::string what = error.what();
        throw std::invalid_argument(what.starts_with(copy.name() + " =")
                                        ? option + what.substr(copy.name().size())
                                        : option + ": " + what);
      }
    };
    const std::string value = number ? "N" : field.choices().empty() ? "TEXT" : "NAME";
    Option& added = command.option_read_by(option, read, value, field.doc());
    added.show_default(field.text() + (field.unit().empty() ? "" : " " + field.unit()));
    if (field.text().empty()) added.show_default("");
    if (number) added.kind("number");
    added.suggest(field.choices());
  }
}

// ---- The program

Command& Program::add(std::string name, std::string group, std::string about,
                      std::string with_examples) {
  Command& command = commands.emplace_back();
  command.name = std::move(name);
  command.group = std::move(group);
  command.summary = std::move(about);
  command.examples = std::move(with_examples) + "\n";
  return command;
}

std::vector<std::string> Program::names() const {
  std::vector<std::string> all;
  for (const Command& command : commands) all.push_back(command.name);
  return all;
}

std::vector<std::string> Program::groups() const { return groups_of(commands); }

const Command& Program::find(const std::string& name) const {
  const auto found = std::ranges::find(commands, name, &Command::name);
  if (found != commands.end()) return *found;
  throw std::invalid_argument(
      fmt::format("unknown verb {}; must be one of {}", name, fmt::join(names(), ", ")));
}

}  // namespace dem::app
