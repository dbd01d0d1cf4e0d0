#include "cli/help.h"

#include <fmt/format.h>

#include <sstream>
#include <string_view>

namespace dem::app {
namespace {

constexpr std::size_t kName = 31, kLine = 100;  // columns

/// `left` in a column of its own, `right` in lines beside it.
std::string row(const std::string& left, const std::string& right) {
  std::string text = "  " + left;
  std::string line(text.size() < kName ? kName - text.size() : 0, ' ');
  if (line.empty()) text += "\n", line.assign(kName, ' ');
  std::istringstream words(right);
  bool first = true;
  std::size_t width = kName;
  text += line;
  for (std::string word; words >> word;) {
    if (!first && width + 1 + word.size() > kLine) {
      text += "\n" + std::string(kName, ' ');
      width = kName;
      first = true;
    }
    text += (first ? "" : " ") + word;
    width += (first ? 0 : 1) + word.size();
    first = false;
  }
  return text + "\n";
}

std::string name_and_value(const Option& option) {
  std::string text = fmt::format("{}", fmt::join(option.names, ","));
  return option.value.empty() ? text : text + " " + option.value;
}

std::string ending(const std::string& examples, const std::string& notes) {
  std::string text;
  if (!examples.empty()) text += "\nExamples:\n" + examples;
  if (!notes.empty()) text += "\n" + notes;
  return text;
}

}  // namespace

std::string remarks(const Option& option) {
  std::string text;
  if (option.repeats && option.doc.find("repeated") == std::string::npos)
    text += option.by_position() ? "; one or more" : "; may be repeated";
  if (option.required && !option.by_position()) text += "; required";
  if (!option.default_text.empty()) text += fmt::format(" [{}]", option.default_text);
  return text;
}

std::string help_text(const Program& program) {
  std::string text = program.summary + "\nUsage: dem VERB [OPTIONS] ...\n";
  for (const std::string& group : program.groups()) {
    text += "\n" + group + ":\n";
    for (const Command& command : program.commands)
      if (command.group == group) text += row(command.name, command.summary);
  }
  text += "\nOptions:\n" + row("-h,--help", "Print this help and exit") +
          row("--version", "Print the version and exit");
  return text + ending(program.examples, program.notes);
}

std::string help_text(const Command& command) {
  std::string text = command.summary + "\nUsage: " + command.synopsis() + "\n";
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const Option& argument : command.arguments)
    text += row(argument.name(), argument.doc + remarks(argument));
  std::vector<std::string> groups{"Options"};
  for (const std::string& group : command.groups())
    if (group != groups.front()) groups.push_back(group);
  for (const std::string& group : groups) {
    text += "\n" + group + ":\n";
    if (group == groups.front()) text += row("-h,--help", "Print this help and exit");
    for (const Option& option : command.options)
      if (option.group == group) text += row(name_and_value(option), option.doc + remarks(option));
  }
  return text + ending(command.examples, command.notes);
}

}  // namespace dem::app
