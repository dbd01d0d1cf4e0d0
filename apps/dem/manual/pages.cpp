#include "manual/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "cli/help.h"
#include "dem/generators.h"
#include "dem/io/methods.h"

namespace dem::app {
namespace {

std::string names_text(const Option& o) {
  std::string text = fmt::format("{}", fmt::join(o.names, ", "));
  if (!o.value.empty()) text += " " + o.value;
  return text;
}

// ---- roff

std::string roff(const std::string& text) {
  std::string out;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '~')
      out += "\\(ti";
    else
      out += c;
    at_start = c == '\n';
  }
  return out;
}

std::string roff_block(const std::string& text) { return fmt::format(".nf\n{}.fi\n", roff(text)); }

std::string roff_head(const std::string& name, const std::string& summary,
                      const std::string& synopsis) {
  std::string title = name;
  std::ranges::transform(title, title.begin(), [](char c) { return c == ' ' ? '-' : c; });
  std::string upper = title;
  std::ranges::transform(upper, upper.begin(),
                         [](unsigned char c) { return char(std::toupper(c)); });
  return fmt::format(
      ".TH {} 1 \"\" \"libdem {}\" \"libdem\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n",
      roff(upper), DEM_VERSION, roff(title), roff(summary), roff(synopsis));
}

std::string roff_list(const std::deque<Option>& list, const std::string& group) {
  std::string text;
  for (const auto& a : list)
    if (a.group == group)
      text += fmt::format(".TP\n.B {}\n{}\n", roff(names_text(a)), roff(a.doc + remarks(a)));
  return text;
}

/// Examples, with two spaces less before each line.
std::string unindented(const std::string& text) {
  std::string out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin) + 1;
    out += text.substr(begin + 2, end - begin - 2);
    begin = end;
  }
  return out;
}

std::string roff_ending(const std::string& examples, const std::string& notes) {
  std::string text;
  if (!notes.empty()) text += ".SH NOTES\n" + roff_block(notes);
  if (!examples.empty()) text += ".SH EXAMPLES\n" + roff_block(unindented(examples));
  return text;
}

// ---- Markdown

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

/// Code in a cell of a table.
std::string code(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c);
  return text.empty() ? "" : fmt::format("`{}`", out);
}

std::string markdown_block(const std::string& kind, const std::string& text) {
  return fmt::format("```{}\n{}```\n", kind, text);
}

std::string markdown_list(const std::deque<Option>& list, const std::string& group) {
  const bool positional = !list.empty() && !list[0].names[0].starts_with("-");
  std::string text = fmt::format("| {} | |\n|---|---|\n", positional ? "argument" : "option");
  for (const auto& a : list)
    if (a.group == group)
      text += fmt::format("| {} | {} |\n", code(names_text(a)), cell(a.doc + remarks(a)));
  return text;
}

std::string markdown_notes(const std::string& notes) {
  return notes.empty() ? "" : fmt::format("\n## Notes\n{}", markdown_block("text", notes));
}

/// A row of the table of methods or of generators.
template <class Row>
std::string markdown_row(const Row& row) {
  std::string text = fmt::format("\n### {}\n{}{}.\n", row.name, row.summary,
                                 row.citation.empty() ? "" : " [" + row.citation + "]");
  if constexpr (requires { row.image; })
    if (!row.image.empty()) text += fmt::format("Starts from an image: {}.\n", row.image);
  if (!row.fields.empty()) text += "\n| setting | default | values | |\n|---|---|---|---|\n";
  for (const auto& f : row.fields)
    text += fmt::format(
        "| `{}` | {} | {} | {} |\n", f.name,
        cell(f.default_text + (f.unit.empty() ? "" : " " + f.unit)),
        cell(f.choices.empty() ? f.type + (f.range.empty() ? "" : ", " + f.range) : f.range),
        cell(f.doc));
  if (!row.presets.empty()) text += "\n| preset | sets | |\n|---|---|---|\n";
  for (const auto& p : row.presets) {
    std::string settings;
    for (const auto& [key, value] : p.settings)
      settings += (settings.empty() ? "" : " ") + key + "=" + value;
    text += fmt::format("| `{}:{}` | {} | {} |\n", row.name, p.name, code(settings), cell(p.doc));
  }
  return text;
}

std::string markdown_tables() {
  std::string text = "\n## Methods of `dem fill`\n";
  for (const auto& m : all_fill_methods()) text += markdown_row(m);
  text += "\n## Generators of `dem generate`\n";
  for (const auto& g : generators()) text += markdown_row(g);
  return text;
}

}  // namespace

std::string man_page(const Command& verb) {
  std::string text = roff_head("dem " + verb.name, verb.summary, verb.synopsis());
  if (!verb.arguments.empty())
    text += ".SH ARGUMENTS\n" + roff_list(verb.arguments, verb.arguments[0].group);
  text += ".SH OPTIONS\n";
  for (const auto& group : verb.groups())
    text += (group == "Options" ? "" : fmt::format(".SS {}\n", roff(group))) +
            roff_list(verb.options, group);
  text += roff_ending(verb.examples, verb.notes);
  return text + ".SH SEE ALSO\n.BR dem (1)\n";
}

std::string man_page(const Program& program) {
  std::string text = roff_head("dem", program.summary, "dem VERB [OPTIONS] ...") + ".SH VERBS\n";
  for (const auto& group : program.groups()) {
    text += fmt::format(".SS {}\n", roff(group));
    for (const auto& verb : program.commands)
      if (verb.group == group)
        text += fmt::format(".TP\n.BR dem\\-{} (1)\n{}\n", roff(verb.name), roff(verb.summary));
  }
  return text + roff_ending(program.examples, program.notes);
}

std::string markdown_page(const Command& verb) {
  std::string text = fmt::format("# dem {}\n{}.\n\n", verb.name, verb.summary);
  text += markdown_block("text", verb.synopsis() + "\n");
  text += "\n## Examples\n" + markdown_block("sh", unindented(verb.examples));
  if (!verb.arguments.empty())
    text += "\n## Arguments\n" + markdown_list(verb.arguments, verb.arguments[0].group);
  for (const auto& group : verb.groups())
    text += fmt::format("\n## {}\n{}", group, markdown_list(verb.options, group));
  text += markdown_notes(verb.notes);
  return text + (verb.name == "methods" ? markdown_tables() : "");
}

std::string markdown_page(const Program& program) {
  std::string text = fmt::format("# dem\n{}\n", program.summary);
  for (const auto& group : program.groups()) {
    text += fmt::format("\n| {} | |\n|---|---|\n", group);
    for (const auto& verb : program.commands)
      if (verb.group == group)
        text += fmt::format("| [dem {0}]({0}.md) | {1} |\n", verb.name, cell(verb.summary));
  }
  return text + "\n" + markdown_block("sh", unindented(program.examples)) +
         markdown_notes(program.notes);
}

}  // namespace dem::app
