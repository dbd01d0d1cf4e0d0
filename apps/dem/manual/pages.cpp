#include "manual/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "dem/generators.h"
#include "dem/io/methods.h"

namespace dem::app {
namespace {

/// The end of a help text: the lines below "Examples:", and what follows them.
struct Footer {
  std::string examples, notes;
};

Footer read_footer(const std::string& text) {
  Footer footer;
  bool in_examples = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line == "Examples:") {
      in_examples = true;
      continue;
    }
    in_examples &= line.starts_with("  ");
    if (in_examples)
      footer.examples += line.substr(2) + "\n";
    else if (!line.empty() || !footer.notes.empty())
      footer.notes += line + "\n";
  }
  return footer;
}

std::string names_text(const ArgumentOutline& o) {
  std::string text = fmt::format("{}", fmt::join(o.names, ", "));
  if (!o.value.empty()) text += " " + o.value;
  return text;
}

/// What is said of an option beside its doc.
std::string remarks(const ArgumentOutline& a) {
  std::string text;
  if (a.repeats) text += a.names[0].starts_with("-") ? "; may be repeated" : "; one or more";
  if (a.required && a.names[0].starts_with("-")) text += "; required";
  if (a.doc.find("may be repeated") != std::string::npos) text.clear();
  if (!a.default_text.empty()) text += fmt::format(" [{}]", a.default_text);
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

std::string roff_list(const std::vector<ArgumentOutline>& list, const std::string& group) {
  std::string text;
  for (const auto& a : list)
    if (a.group == group)
      text += fmt::format(".TP\n.B {}\n{}\n", roff(names_text(a)), roff(a.doc + remarks(a)));
  return text;
}

std::string roff_footer(const Footer& footer) {
  std::string text;
  if (!footer.notes.empty()) text += ".SH NOTES\n" + roff_block(footer.notes);
  if (!footer.examples.empty()) text += ".SH EXAMPLES\n" + roff_block(footer.examples);
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

std::string markdown_list(const std::vector<ArgumentOutline>& list, const std::string& group) {
  const bool positional = !list.empty() && !list[0].names[0].starts_with("-");
  std::string text = fmt::format("| {} | |\n|---|---|\n", positional ? "argument" : "option");
  for (const auto& a : list)
    if (a.group == group)
      text += fmt::format("| {} | {} |\n", code(names_text(a)), cell(a.doc + remarks(a)));
  return text;
}

std::string markdown_footer(const Footer& footer) {
  if (footer.notes.empty()) return "";
  return fmt::format("\n## Notes\n{}", markdown_block("text", footer.notes));
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

std::string man_page(const VerbOutline& verb) {
  std::string text = roff_head("dem " + verb.name, verb.summary, verb.synopsis());
  if (!verb.arguments.empty())
    text += ".SH ARGUMENTS\n" + roff_list(verb.arguments, verb.arguments[0].group);
  text += ".SH OPTIONS\n";
  for (const auto& group : groups(verb))
    text += (group == "Options" ? "" : fmt::format(".SS {}\n", roff(group))) +
            roff_list(verb.options, group);
  text += roff_footer(read_footer(verb.footer));
  return text + ".SH SEE ALSO\n.BR dem (1)\n";
}

std::string man_page(const std::vector<VerbOutline>& verbs, const std::string& about,
                     const std::string& footer) {
  std::string text = roff_head("dem", about, "dem VERB [OPTIONS] ...") + ".SH VERBS\n";
  for (const auto& verb : verbs)
    text += fmt::format(".TP\n.BR dem\\-{} (1)\n{}\n", roff(verb.name), roff(verb.summary));
  return text + roff_footer(read_footer(footer));
}

std::string markdown_page(const VerbOutline& verb) {
  const Footer footer = read_footer(verb.footer);
  std::string text = fmt::format("# dem {}\n{}.\n\n", verb.name, verb.summary);
  text += markdown_block("text", verb.synopsis() + "\n");
  if (!footer.examples.empty()) text += "\n## Examples\n" + markdown_block("sh", footer.examples);
  if (!verb.arguments.empty())
    text += "\n## Arguments\n" + markdown_list(verb.arguments, verb.arguments[0].group);
  for (const auto& group : groups(verb))
    text += fmt::format("\n## {}\n{}", group, markdown_list(verb.options, group));
  text += markdown_footer(footer);
  return text + (verb.name == "methods" ? markdown_tables() : "");
}

std::string markdown_page(const std::vector<VerbOutline>& verbs, const std::string& about,
                          const std::string& footer) {
  const Footer end = read_footer(footer);
  std::string text = fmt::format("# dem\n{}\n\n| verb | does |\n|---|---|\n", about);
  for (const auto& verb : verbs)
    text += fmt::format("| [dem {0}]({0}.md) | {1} |\n", verb.name, cell(verb.summary));
  return text + "\n" + markdown_block("sh", end.examples) + markdown_footer(end);
}

}  // namespace dem::app
