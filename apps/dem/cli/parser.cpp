#include "cli/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace dem::app {
namespace {

/// How many letters must change to make one word of the other (Levenshtein).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t swap = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, swap});
    }
  }
  return row.back();
}

/// One pass over the words: what each option and argument is given.
class Reader {
 public:
  Reader(Command& command, const std::vector<std::string>& words)
      : command_(command), words_(words) {}

  Parsed read() {
    for (bool only_arguments = false; at_ < words_.size();) {
      const std::string& word = words_[at_++];
      if (only_arguments || word == "-" || !word.starts_with('-'))
        arguments_.push_back(word);
      else if (word == "--")
        only_arguments = true;
      else if (word == "--help" || word == "-h")
        return Parsed::help_wanted;
      else if (word.starts_with("--"))
        read_long(word);
      else
        read_short(word);
    }
    give_arguments();
    for (const auto& [option, text] : given_) option->accept(text);
    for (const Option& option : command_.options)
      if (option.required && option.count == 0) fail(option.name() + " is missing");
    return Parsed::all;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw UsageError(fmt::format("{} (see `dem {} --help`)", what, command_.name));
  }

  Option& option(const std::string& name) const {
    if (Option* found = command_.find(name)) return *found;
    std::vector<std::string> names{"--help"};
    for (const Option& o : command_.options) names.push_back(o.name());
    fail("unknown option " + name + suggestion(name, names));
  }

  /// The word after an option that takes a value; another option is none.
  const std::string& value_of(const Option& option) {
    if (at_ == words_.size()) fail(fmt::format("{} needs a value", option.name()));
    const std::string& word = words_[at_++];
    if (command_.find(word.substr(0, word.find('='))))
      fail(fmt::format("{} needs a value; {} is an option", option.name(), word));
    return word;
  }

  void read_long(const std::string& word) {
    const auto equals = word.find('=');
    Option& found = option(word.substr(0, equals));
    if (found.is_switch() && equals != word.npos)
      fail(fmt::format("{} takes no value", found.name()));
    given_.emplace_back(&found, found.is_switch()     ? ""
                                : equals == word.npos ? value_of(found)
                                                      : word.substr(equals + 1));
  }

  void read_short(const std::string& word) {
    for (std::size_t i = 1; i < word.size(); ++i) {
      Option& found = option(std::string("-") + word[i]);
      if (found.is_switch()) {
        given_.emplace_back(&found, "");
        continue;
      }
      given_.emplace_back(&found, i + 1 < word.size() ? word.substr(i + 1) : value_of(found));
      return;
    }
  }

  /// Arguments that need not be there take what those that must be there leave.
  void give_arguments() {
    auto& wanted = command_.arguments;
    const auto needed = std::size_t(std::ranges::count(wanted, true, &Option::required));
    std::size_t spare = arguments_.size() - std::min(needed, arguments_.size()), next = 0;
    for (Option& argument : wanted) {
      std::size_t takes = argument.required;
      if (argument.repeats) takes += std::exchange(spare, 0);
      if (!argument.required && !argument.repeats && spare > 0) --spare, takes = 1;
      if (next + takes > arguments_.size()) fail(argument.name() + " is missing");
      for (; takes > 0; --takes) given_.emplace_back(&argument, arguments_[next++]);
    }
    if (next < arguments_.size()) fail("unexpected argument " + arguments_[next]);
  }

  Command& command_;
  const std::vector<std::string>& words_;
  std::size_t at_ = 0;
  std::vector<std::string> arguments_;
  std::vector<std::pair<Option*, std::string>> given_;
};

}  // namespace

std::string suggestion(std::string_view word, const std::vector<std::string>& names) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const auto& name : names)
    if (const auto d = distance(word, name); d < least) least = d, best = name;
  return best.empty() ? "" : "; did you mean " + best + "?";
}

Parsed parse(Command& command, const std::vector<std::string>& words) {
  return Reader(command, words).read();
}

}  // namespace dem::app
