#include "manual/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace dem::app {
namespace {

enum class Value { words, files, folders, anything };

Value value_of(const Option& a) {
  if (!a.choices.empty()) return Value::words;
  if (a.takes.ends_with("folder")) return Value::folders;
  return a.takes.empty() || a.takes == "number" || a.takes == "crs" ? Value::anything
                                                                    : Value::files;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

/// A backslash before each of `special`.
std::string escaped(const std::string& text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// The words for the first argument, when it is one of some names.
std::vector<std::string> first_words(const Command& verb) {
  return verb.arguments.empty() ? std::vector<std::string>() : verb.arguments[0].choices;
}

// ---- bash

/// Words are taken from the line itself, since bash cuts them at ":" and "=".
const char* kBashHead = R"(# Completion of `dem` in bash; made by `dem completion bash`.
_dem_words() {
  compopt +o default 2> /dev/null
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur")
  # What stands before the last colon is a word of its own to bash.
  if [[ $cur == *:* && $COMP_WORDBREAKS == *:* ]]; then
    COMPREPLY=("${COMPREPLY[@]#"${cur%"${cur##*:}"}"}")
  fi
}

_dem() {
  local line=${COMP_LINE:0:COMP_POINT} words cur prev
  read -ra words <<< "$line"
  if [[ $line == *[[:space:]] ]]; then words+=(""); fi
  local count=${#words[@]}
  cur=${words[count - 1]}
  prev=${words[count - 2]}
  COMPREPLY=()
)";

std::string bash_verb(const Command& verb) {
  std::vector<std::string> options{"--help"}, folders, anything;
  std::string cases;
  for (const auto& o : verb.options) {
    options.push_back(o.names.back());
    const std::string names = fmt::format("{}", fmt::join(o.names, "|"));
    if (o.value.empty()) continue;
    if (value_of(o) == Value::words)
      cases += fmt::format("        {}) _dem_words \"{}\"; return ;;\n", names, joined(o.choices));
    else if (value_of(o) == Value::files)
      cases += fmt::format("        {}) return ;;\n", names);
    else if (value_of(o) == Value::folders)
      folders.push_back(names);
    else
      anything.push_back(names);
  }
  if (!folders.empty())
    cases += fmt::format("        {}) compopt -o dirnames; return ;;\n", fmt::join(folders, "|"));
  if (!anything.empty())
    cases += fmt::format("        {}) compopt +o default; return ;;\n", fmt::join(anything, "|"));
  std::string text = fmt::format("    {})\n      case $prev in\n{}      esac\n", verb.name, cases);
  text += fmt::format("      if [[ $cur == -* ]]; then _dem_words \"{}\"; return; fi\n",
                      joined(options));
  if (const auto words = first_words(verb); !words.empty())
    text += fmt::format("      if ((count == 3)); then _dem_words \"{}\"; fi\n", joined(words));
  return text + "      ;;\n";
}

std::string bash(const Program& program) {
  std::string text = kBashHead;
  text += fmt::format("  if ((count < 3)); then _dem_words \"{} --help --version\"; return; fi\n",
                      joined(program.names()));
  text += "  case ${words[1]} in\n";
  for (const auto& verb : program.commands) text += bash_verb(verb);
  return text + "  esac\n}\ncomplete -o default -F _dem dem\n";
}

// ---- zsh

/// For use within single quotes in a specification of _arguments.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : escaped(text, "[]:\\"))
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  return out;
}

std::string zsh_value(const Option& a) {
  switch (value_of(a)) {
    case Value::words:
      return fmt::format("({})", escaped(joined(a.choices), ":"));
    case Value::files:
      return "_files";
    case Value::folders:
      return "_files -/";
    case Value::anything:
      break;
  }
  return " ";
}

std::string zsh_option(const Option& o) {
  const std::string value =
      o.value.empty() ? "" : fmt::format(":{}:{}", zsh_text(o.value), zsh_value(o));
  const std::string tail = fmt::format("'[{}]{}'", zsh_text(o.doc), value);
  const std::string star = o.repeats ? "*" : "";
  if (o.names.size() == 1) return fmt::format("'{}'{}{}", star, o.names[0], tail);
  return fmt::format("'{}'{{{}}}{}", o.repeats ? "*" : fmt::format("({})", joined(o.names)),
                     fmt::join(o.names, ","), tail);
}

std::string zsh_verb(const Command& verb) {
  std::string text = fmt::format("    {})\n      _arguments -S \\\n", verb.name);
  for (const auto& o : verb.options) text += fmt::format("        {} \\\n", zsh_option(o));
  text += "        '(-h --help)'{-h,--help}'[help and examples]'";
  for (const auto& a : verb.arguments)
    text += fmt::format(" \\\n        '{}:{}:{}'", a.repeats ? "*" : "", a.names[0], zsh_value(a));
  return text + " ;;\n";
}

std::string zsh(const Program& program) {
  std::string text =
      "#compdef dem\n# Completion of `dem` in zsh; made by `dem completion zsh`.\n_dem() {\n"
      "  local -a verbs=(\n";
  for (const auto& verb : program.commands)
    text += fmt::format("    '{}:{}'\n", verb.name, zsh_text(verb.summary));
  text +=
      "  )\n  if ((CURRENT == 2)); then\n    _describe verb verbs\n    return\n  fi\n"
      "  local verb=$words[2]\n  shift words\n  ((CURRENT--))\n  case $verb in\n";
  for (const auto& verb : program.commands) text += zsh_verb(verb);
  return text +
         "  esac\n}\n"
         "if [[ $funcstack[1] == _dem ]]; then _dem \"$@\"; else compdef _dem dem; fi\n";
}

// ---- fish

std::string fish_text(const std::string& text) { return fmt::format("'{}'", escaped(text, "\\'")); }

std::string fish_value(const Option& a) {
  switch (value_of(a)) {
    case Value::words:
      return fmt::format(" -x -a {}", fish_text(joined(a.choices)));
    case Value::files:
      return " -r -F";
    case Value::folders:
      return " -x -a '(__fish_complete_directories)'";
    case Value::anything:
      break;
  }
  return " -x";
}

std::string fish_option(const std::string& start, const Option& o) {
  std::string text = start;
  for (const auto& name : o.names)
    text += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2))
                                   : fmt::format(" -s {}", name.substr(1));
  return fmt::format("{}{} -d {}\n", text, o.value.empty() ? "" : fish_value(o), fish_text(o.doc));
}

std::string fish(const Program& program) {
  std::string text = "# Completion of `dem` in fish; made by `dem completion fish`.\n";
  text += "complete -c dem -f\n";
  for (const auto& verb : program.commands)
    text += fmt::format("complete -c dem -n __fish_use_subcommand -a {} -d {}\n", verb.name,
                        fish_text(verb.summary));
  text += "complete -c dem -n __fish_use_subcommand -l version -d 'version of dem'\n";
  text += "complete -c dem -s h -l help -d 'help and examples'\n";
  for (const auto& verb : program.commands) {
    const std::string start =
        fmt::format("complete -c dem -n '__fish_seen_subcommand_from {}'", verb.name);
    for (const auto& o : verb.options) text += fish_option(start, o);
    for (const auto& a : verb.arguments)
      if (value_of(a) != Value::anything)
        text += start + (value_of(a) == Value::words ? fish_value(a) : " -F") + "\n";
  }
  return text;
}

}  // namespace

std::vector<std::string> shells() { return {"bash", "zsh", "fish"}; }

std::string completion(const std::string& shell, const Program& program) {
  return shell == "bash" ? bash(program) : shell == "zsh" ? zsh(program) : fish(program);
}

}  // namespace dem::app
