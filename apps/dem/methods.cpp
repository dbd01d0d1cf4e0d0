// dem methods: what `dem fill --method` and `--set` take.

#include "dem/methods.h"

#include <CLI/CLI.hpp>

#include "dem/baselines.h"
#include "verbs.h"

namespace dem::app {
namespace {

Json as_json(const FillMethod& m) {
  Json fields = Json::array(), presets = Json::array();
  for (const auto& f : m.fields)
    fields.push_back({{"name", f.name},
                      {"type", f.type},
                      {"unit", f.unit},
                      {"range", f.range},
                      {"default", f.default_text},
                      {"choices", f.choices},
                      {"doc", f.doc}});
  for (const auto& p : m.presets) {
    Json settings = Json::object();
    for (const auto& [key, value] : p.settings) settings[key] = value;
    presets.push_back({{"name", p.name}, {"doc", p.doc}, {"settings", settings}});
  }
  return {{"name", m.name},         {"summary", m.summary},
          {"citation", m.citation}, {"default", m.name == default_fill_method()},
          {"fields", fields},       {"presets", presets}};
}

std::string as_text(const FillMethod& m) {
  std::string text = fmt::format("{}  {}{}\n", m.name, m.summary,
                                 m.citation.empty() ? "" : " [" + m.citation + "]");
  for (const auto& f : m.fields) {
    const std::string unit = f.unit.empty() ? "" : " " + f.unit;
    text += fmt::format("  {:<18} {}{}   ({}{})\n      {}\n", f.name, f.default_text, unit, f.type,
                        f.range.empty() ? "" : ", " + f.range, f.doc);
  }
  for (const auto& p : m.presets) {
    std::string settings;
    for (const auto& [key, value] : p.settings) settings += " " + key + "=" + value;
    text += fmt::format("  preset {}:{}   {}\n     {}\n", m.name, p.name, p.doc, settings);
  }
  return text;
}

int methods(const std::string& name, Shell& shell) {
  Json fill = Json::array();
  std::string text;
  for (const auto& m : all_fill_methods()) {
    if (!name.empty() && &m != find_method(all_fill_methods(), name).method) continue;
    fill.push_back(as_json(m));
    text += (text.empty() ? "" : "\n") + as_text(m);
  }
  shell.print({{"fill", fill}, {"generators", Json::array()}}, text);
  return kDone;
}

}  // namespace

void add_methods(CLI::App& app, Shell& shell) {
  const auto name = std::make_shared<std::string>();
  auto* verb =
      add_verb(app, shell, "methods", "Every fill method: settings, ranges, defaults, citation",
               "  dem methods\n"
               "  dem methods mcmd                   # one method\n"
               "  dem methods --json | jq '.fill[].name'",
               [name, &shell] { return methods(*name, shell); });
  verb->add_option("NAME", *name, "one method; all, when left out")->type_name("");
}

}  // namespace dem::app
