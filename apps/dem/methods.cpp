// dem methods: what `dem fill`, `dem generate` and their `--set` take.

#include "dem/methods.h"

#include "dem/deterrace.h"
#include "dem/draw.h"
#include "dem/erosion.h"
#include "dem/generators.h"
#include "dem/greedy.h"
#include "dem/gridding.h"
#include "dem/io/methods.h"
#include "dem/io/point_files.h"
#include "dem/io/rasters.h"
#include "dem/raytrace.h"
#include "dem/sample.h"
#include "dem/supersample.h"
#include "verbs.h"

namespace dem::app {
namespace {

Json as_json(const std::vector<FieldInfo>& fields) {
  Json all = Json::array();
  for (const auto& f : fields)
    all.push_back({{"name", f.name},
                   {"type", f.type},
                   {"unit", f.unit},
                   {"range", f.range},
                   {"default", f.default_text},
                   {"choices", f.choices},
                   {"doc", f.doc}});
  return all;
}

Json as_json(const std::vector<Preset>& presets) {
  Json all = Json::array();
  for (const auto& p : presets) {
    Json settings = Json::object();
    for (const auto& [key, value] : p.settings) settings[key] = value;
    all.push_back({{"name", p.name}, {"doc", p.doc}, {"settings", settings}});
  }
  return all;
}

Json as_json(const FillMethod& m) {
  return {{"name", m.name},
          {"summary", m.summary},
          {"citation", m.citation},
          {"default", m.name == default_fill_method()},
          {"for_contours", m.traits.for_contours},
          {"honours_breaklines", m.traits.honours_breaklines},
          {"bytes_per_cell", m.traits.bytes_per_cell.value},
          {"takes_point_sigma", bool(m.fill_noisy)},
          {"fields", as_json(m.fields)},
          {"presets", as_json(m.presets)}};
}

Json as_json(const Generator& g) {
  return {{"name", g.name},
          {"summary", g.summary},
          {"citation", g.citation},
          {"image", g.image},
          {"globe", g.globe},
          {"fields", as_json(g.fields)},
          {"presets", as_json(g.presets)}};
}

Json as_json(const std::deque<Option>& options) {
  Json all = Json::array();
  for (const Option& o : options)
    all.push_back({{"names", o.names},
                   {"value", o.value},
                   {"doc", o.doc},
                   {"group", o.group},
                   {"takes", o.takes},
                   {"choices", o.choices},
                   {"required", o.required},
                   {"repeats", o.repeats},
                   {"default", o.default_text}});
  return all;
}

/// The verbs with their options: for programs that offer them in another form.
Json as_json(const Program& program) {
  Json all = Json::array();
  for (const Command& c : program.commands)
    all.push_back({{"name", c.name},
                   {"summary", c.summary},
                   {"group", c.group},
                   {"arguments", as_json(c.arguments)},
                   {"options", as_json(c.options)}});
  return all;
}

template <class Options>
Json fields_of() {
  Options defaults;
  return as_json(describe(fields(defaults)));
}

/// The fields of several options structs, one after the other.
template <class... Options>
Json fields_of_all() {
  Json all = Json::array();
  const auto append = [&](const Json& some) { all.insert(all.end(), some.begin(), some.end()); };
  (append(fields_of<Options>()), ...);
  return all;
}

/// The options of the library that stand behind those of verbs.
Json option_tables() {
  return {{"grid", fields_of_all<BinOptions, GriddingOptions>()},
          {"points", fields_of<PointReadOptions>()},
          {"supersample", fields_of<SupersampleOptions>()},
          {"sample", {{"greedy", fields_of<GreedyOptions>()}, {"voids", fields_of<VoidOptions>()}}},
          {"deterrace", fields_of<DeterraceOptions>()},
          {"read", fields_of<ReadOptions>()},
          {"write", fields_of<WriteOptions>()}};
}

/// A row of either table.
template <class Row>
std::string as_text(const Row& row) {
  std::string text = fmt::format("{}  {}{}\n", row.name, row.summary,
                                 row.citation.empty() ? "" : " [" + row.citation + "]");
  if constexpr (requires { row.image; })
    if (!row.image.empty()) text += fmt::format("  starts from an image: {}\n", row.image);
  if constexpr (requires { row.traits; }) {
    if (row.traits.for_contours) text += "  for contour lines only\n";
    if (row.traits.honours_breaklines) text += "  honours breaklines\n";
  }
  for (const auto& f : row.fields) {
    const std::string unit = f.unit.empty() ? "" : " " + f.unit;
    text += fmt::format("  {:<18} {}{}   ({}{})\n      {}\n", f.name, f.default_text, unit, f.type,
                        f.range.empty() ? "" : ", " + f.range, f.doc);
  }
  for (const auto& p : row.presets) {
    std::string settings;
    for (const auto& [key, value] : p.settings) settings += " " + key + "=" + value;
    text += fmt::format("  preset {}:{}   {}\n     {}\n", row.name, p.name, p.doc, settings);
  }
  return text;
}

/// The rows called `name` (all, when it is empty), as JSON, their text added to `text`.
template <class Row>
Json rows_of(const std::vector<Row>& table, const std::string& name, const std::string& title,
             std::string& text) {
  Json rows = Json::array();
  for (const auto& row : table) {
    if (!name.empty() && row.name != name) continue;
    if (name.empty() && rows.empty()) text += (text.empty() ? "" : "\n") + title + "\n";
    if (name.empty() || !rows.empty()) text += "\n";
    text += as_text(row);
    rows.push_back(as_json(row));
  }
  return rows;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const auto& m : all_fill_methods()) names.push_back(m.name);
  for (const auto& g : generators()) names.push_back(g.name);
  return names;
}

int methods(const std::string& wanted, const Program& program, Shell& shell) {
  const std::string name = wanted.substr(0, wanted.find(':'));
  std::string text;
  const Json fill = rows_of(all_fill_methods(), name, "Methods of `dem fill`:", text);
  const Json made = rows_of(generators(), name, "Generators of `dem generate`:", text);
  if (fill.empty() && made.empty())
    throw std::invalid_argument(fmt::format("unknown method \"{}\"; must be one of {}", wanted,
                                            fmt::join(method_names(), ", ")));
  Json tables{{"fill", fill}, {"generators", made}};
  if (name.empty()) {
    tables["erosion"] = fields_of<ErosionOptions>();
    tables["styles"] = {{"hillshade", fields_of<HillshadeOptions>()},
                        {"relief", fields_of<ReliefOptions>()},
                        {"view", fields_of<ViewOptions>()}};
    tables["options"] = option_tables();
    tables["verbs"] = as_json(program);
  }
  shell.print(tables, text);
  return kDone;
}

}  // namespace

void add_methods(Program& program, Shell& shell) {
  const auto name = std::make_shared<std::string>();
  Command& verb =
      program.add("methods", kAbout, "List the fill methods and generators with their settings",
                  "  dem methods\n"
                  "  dem methods mcmd                   # one of them\n"
                  "  dem methods --json | jq '.fill[].name'");
  verb.work = [name, &program, &shell] { return methods(*name, program, shell); };
  verb.argument("NAME", *name, "Name of one of them (all of them)").suggest(method_names());
}

}  // namespace dem::app
