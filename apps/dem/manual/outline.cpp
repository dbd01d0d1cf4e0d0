#include "manual/outline.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>

#include "common.h"

namespace dem::app {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

/// Reads the marks that takes() and choices() left among the validators of an option.
void read_marks(CLI::Option& option, ArgumentOutline& out) {
  for (int i = 0;; ++i) {
    const CLI::Validator* mark = nullptr;
    try {
      mark = option.get_validator(i);
    } catch (const CLI::OptionNotFound&) {
      return;
    }
    const std::string& name = mark->get_name();
    if (name.starts_with(kTakesMark)) out.takes = name.substr(kTakesMark.size());
    if (name.starts_with(kChoicesMark)) out.choices = split(name.substr(kChoicesMark.size()), '|');
  }
}

ArgumentOutline outline(CLI::Option& option) {
  ArgumentOutline out;
  for (const auto& name : option.get_snames()) out.names.push_back(fmt::format("-{}", name));
  for (const auto& name : option.get_lnames()) out.names.push_back(fmt::format("--{}", name));
  if (option.get_positional()) out.names = {option.get_name(true)};
  out.value = option.get_items_expected_max() == 0 ? "" : option.get_type_name();
  out.doc = option.get_description();
  std::ranges::replace(out.doc, '\n', ' ');
  out.group = option.get_group();
  out.default_text = option.get_default_str();
  out.required = option.get_required();
  out.repeats = option.get_items_expected_max() > 1;
  read_marks(option, out);
  return out;
}

VerbOutline outline_of(CLI::App& verb) {
  VerbOutline out{verb.get_name(), verb.get_description(), {}, {}, verb.get_footer()};
  for (auto* option : verb.get_options()) {
    if (option == verb.get_help_ptr()) continue;
    (option->get_positional() ? out.arguments : out.options).push_back(outline(*option));
  }
  return out;
}

}  // namespace

std::string VerbOutline::synopsis() const {
  std::string text = "dem " + name + " [OPTIONS]";
  for (const auto& a : arguments) {
    const std::string words = a.names[0] + (a.repeats ? "..." : "");
    text += a.required ? " " + words : fmt::format(" [{}]", words);
  }
  return text;
}

std::vector<VerbOutline> outline(CLI::App& app) {
  std::vector<VerbOutline> verbs;
  for (auto* verb : app.get_subcommands([](CLI::App*) { return true; }))
    verbs.push_back(outline_of(*verb));
  return verbs;
}

const VerbOutline& find_verb(const std::vector<VerbOutline>& verbs, const std::string& name) {
  const auto found = std::ranges::find(verbs, name, &VerbOutline::name);
  if (found != verbs.end()) return *found;
  std::vector<std::string> names;
  for (const auto& v : verbs) names.push_back(v.name);
  throw std::invalid_argument(
      fmt::format("unknown verb \"{}\"; must be one of {}", name, fmt::join(names, ", ")));
}

std::vector<std::string> groups(const VerbOutline& verb) {
  std::vector<std::string> names;
  for (const auto& option : verb.options)
    if (std::ranges::count(names, option.group) == 0) names.push_back(option.group);
  return names;
}

}  // namespace dem::app
