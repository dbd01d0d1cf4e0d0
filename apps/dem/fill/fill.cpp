// dem fill: fill the holes of a DEM.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>

#include "dem/baselines.h"
#include "fill/hole_fill.h"
#include "fill/stream_fill.h"
#include "verbs.h"

namespace dem::app {
namespace {

const std::vector<std::pair<std::string, CellType>> kTypes{
    {"int8", CellType::int8},       {"uint8", CellType::uint8},    {"int16", CellType::int16},
    {"uint16", CellType::uint16},   {"int32", CellType::int32},    {"uint32", CellType::uint32},
    {"float32", CellType::float32}, {"float64", CellType::float64}};

struct Options {
  std::string in, out, sigma;
  std::optional<int> realisation;
  std::string roughness;  // "auto" or a number
  std::optional<std::uint64_t> seed;
  std::string method{default_fill_method()};
  std::vector<std::string> set;
  std::string origin, table, memory, water;
  std::vector<std::string> aux;
  bool resume = false;
  bool whole = false;
  HoleChoice choice;
  ReadOptions read;
  WriteOptions write;
};

/// A DEM of one known cell: cheap to fill, so that bad settings show before long work.
Dem one_cell() { return {Raster<float>({1, 1}), Mask({1, 1}, 1), {}, {}}; }

/// Adds a setting that an option of its own stands for, unless it is among the settings already.
void add_setting(ChosenMethod& chosen, const std::string& name, const std::string& value,
                 const std::string& option) {
  if (std::ranges::find(chosen.method->fields, name, &FieldInfo::name) ==
      chosen.method->fields.end())
    throw std::invalid_argument(
        fmt::format("{}: method {} has no setting {}", option, chosen.method->name, name));
  if (std::ranges::find(chosen.settings, name, &Settings::value_type::first) ==
      chosen.settings.end())
    chosen.settings.emplace_back(name, value);
}

ChosenMethod choose(const Options& o) {
  ChosenMethod chosen = find_method(all_fill_methods(), o.method);
  for (const auto& text : o.set) chosen.settings.push_back(parse_setting(text));
  if (!o.sigma.empty()) add_setting(chosen, "sigma", "law", "--sigma");
  if (o.realisation)
    add_setting(chosen, "realisation", std::to_string(*o.realisation), "--realisation");
  if (!o.roughness.empty()) {
    add_setting(chosen, "realisation", "1", "--roughness");
    if (o.roughness != "auto") add_setting(chosen, "roughness", o.roughness, "--roughness");
  }
  if (o.seed) add_setting(chosen, "seed", std::to_string(*o.seed), "--seed");
  const Filled trial = chosen.method->fill(one_cell(), chosen.settings, {});
  if (!o.sigma.empty() && trial.sigma.empty())
    throw std::invalid_argument("sigma: method " + chosen.method->name +
                                " gives no standard deviation");
  return chosen;
}

std::string settings_text(const Settings& settings) {
  std::string text;
  for (const auto& [key, value] : settings) text += (text.empty() ? "" : " ") + key + "=" + value;
  return text;
}

/// What became of the known cells: in another type they need not be the same.
std::string known_cells(const Options& o, const FillOutcome& out, CellType type) {
  if (!out.known_kept) return "CHANGED";
  const std::string sum = fmt::format(" (checksum {:016x})", out.known_checksum);
  if (!o.write.type || *o.write.type == type) return "unchanged" + sum;
  return "written as " +
         std::ranges::find(kTypes, *o.write.type, &decltype(kTypes)::value_type::second)->first;
}

void report(const Options& o, const ChosenMethod& chosen, const FillOutcome& out, CellType type,
            Shell& shell) {
  if (out.unknown == 0) {
    shell.say("all cells are known: {} is a copy of {}", o.out, o.in);
  } else {
    std::vector<Verdict> verdicts;
    for (const auto& hole : out.outcomes) verdicts.push_back(hole.verdict);
    std::string left = left_text(out.holes, verdicts);
    if (out.left) left += fmt::format(", {} left unfilled", grouped(out.left));
    if (out.memory_needed)
      left += fmt::format(" (--memory {}M would do)", (out.memory_needed >> 20) + 1);
    if (out.guide_cells)
      left += fmt::format(", {} over an auxiliary DEM", grouped(out.guide_cells));
    if (out.water_cells) left += fmt::format(", {} flat as water", grouped(out.water_cells));
    shell.say(
        "filled {} of {} unknown cells ({} of {} voids touch the border: {} cells){}; {}, {} "
        "window{}, {:.3f} s; known cells {}: {}",
        grouped(out.filled), grouped(out.unknown), grouped(out.border_holes),
        grouped(out.holes.size()), grouped(out.border_cells), left, o.method, grouped(out.windows),
        out.windows == 1 ? "" : "s", out.seconds, known_cells(o, out, type), o.out);
  }
  Json aux = Json::array();
  for (const auto& fit : out.aux) {
    if (!fit.warning.empty()) shell.say("warning: {} {}", fit.path, fit.warning);
    aux.push_back({{"path", fit.path},
                   {"offset_m", fit.offset_m},
                   {"shift_cells", {fit.shift_cols, fit.shift_rows}},
                   {"warning", fit.warning}});
  }
  Json figures = Json::array();
  for (const auto& f : out.figures)
    figures.push_back({{"name", f.name}, {"value", f.value}, {"unit", f.unit}});
  Json settings = Json::object();
  for (const auto& [key, value] : chosen.settings) settings[key] = value;
  shell.print({{"output", o.out},
               {"method", o.method},
               {"settings", settings},
               {"unknown", out.unknown},
               {"voids", out.holes.size()},
               {"border_voids", out.border_holes},
               {"border_void_cells", out.border_cells},
               {"windows", out.windows},
               {"filled", out.filled},
               {"water", out.water_cells},
               {"over_aux", out.guide_cells},
               {"aux", aux},
               {"left_at_border", out.left_at_border},
               {"left_by_choice", out.left_by_choice},
               {"left", out.left},
               {"known_unchanged", out.known_kept},
               {"known_checksum", fmt::format("{:016x}", out.known_checksum)},
               {"seconds", out.seconds},
               {"report", figures}},
              "");
}

const std::vector<CellClass> kOrigins{{0, "measured", {160, 160, 160}},
                                      {1, "filled by method", {230, 120, 30}},
                                      {2, "filled over an auxiliary DEM", {90, 160, 60}},
                                      {3, "water, flat", {50, 110, 200}},
                                      {4, "left void", {0, 0, 0}}};

Source layer_source(const Source& of, std::string description) {
  Source source;
  source.node_registered = of.node_registered;
  source.band_description = std::move(description);
  return source;
}

Source sigma_source(const Source& of) {
  return layer_source(of, "standard deviation of the elevation in metres");
}

Source origin_source(const Source& of) {
  Source source = layer_source(of, "where each height comes from");
  source.type = CellType::uint8;
  return source;
}

WriteOptions layer_options(bool overwrite) {
  WriteOptions options;
  options.overwrite = overwrite;
  return options;
}

WriteOptions origin_options(bool overwrite) {
  WriteOptions options = layer_options(overwrite);
  options.classes = kOrigins;
  return options;
}

/// What the output says of its making.
std::vector<std::pair<std::string, std::string>> making(const Options& o,
                                                        const ChosenMethod& chosen,
                                                        const FillOutcome& out,
                                                        const Shell& shell) {
  if (out.unknown == 0 || !holds_metadata(o.out, o.write.format)) return {};
  return {{"DEM_INPUT", o.in},
          {"DEM_COMMAND", shell.command},
          {"DEM_METHOD", o.method},
          {"DEM_SETTINGS", settings_text(chosen.settings)},
          {"DEM_KNOWN_CHECKSUM", fmt::format("{:016x}", out.known_checksum)},
          {"DEM_VERSION", DEM_VERSION}};
}

void write_table(const Options& o, const FillOutcome& out, bool overwrite) {
  const Json table{{"input", o.in}, {"output", o.out}, {"holes", hole_table(out, o.method)}};
  write_text(o.table, table.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", overwrite);
}

int exit_code(const FillOutcome& out) {
  if (!out.known_kept) return kCheckFailed;
  return out.left > 0 ? kUnfilled : kDone;
}

/// Strip by strip, within a bound of memory.
int fill_stream(const Options& o, const FillRequest& request, std::size_t memory, Shell& shell) {
  const Run run = shell.run();
  StreamFill::Options options{o.in, o.out, o.read, memory, o.resume, ""};
  for (const auto& part : {o.method, settings_text(request.method.settings), o.choice.text(),
                           o.sigma, o.table, std::string(o.whole ? "whole" : ""), o.memory, o.water,
                           fmt::format("{}", fmt::join(o.aux, " "))})
    options.settings += part + " | ";
  StreamFill job(options, request, run.part(0, 0.7));
  FillOutcome& out = job.outcome();
  if (job.resumed_windows() > 0)
    shell.say("resumed: {} of {} windows were done", grouped(job.resumed_windows()),
              grouped(out.windows));

  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  write.metadata = making(o, request.method, out, shell);
  if (!o.sigma.empty())
    job.write(o.sigma, StreamFill::Layer::sigma, sigma_source(job.source()),
              layer_options(shell.overwrite), run.part(0.7, 0.8));
  if (!o.origin.empty())
    job.write(o.origin, StreamFill::Layer::origin, origin_source(job.source()),
              origin_options(shell.overwrite), run.part(0.8, 0.85));
  if (!o.table.empty()) write_table(o, out, shell.overwrite);
  job.write(o.out, StreamFill::Layer::heights, job.source(), write, run.part(0.85, 1));
  job.finish();
  report(o, request.method, out, job.source().type, shell);
  return exit_code(out);
}

/// The bytes that may be used when the raster is to be worked on part by part; 0: as a whole.
std::size_t stream_memory(const Options& o) {
  if (!o.memory.empty()) return parse_memory("memory", o.memory);
  return o.resume ? machine_memory() / 2 : 0;
}

int fill(const Options& o, Shell& shell) {
  const ChosenMethod chosen = choose(o);
  check(o.choice);
  const std::size_t memory = stream_memory(o);
  for (const std::string& path : {o.out, o.sigma, o.origin, o.table})
    if (!path.empty()) check_writable(path, shell.overwrite);

  const FillRequest request{chosen,           o.choice,          o.whole, !o.table.empty(),
                            !o.sigma.empty(), !o.origin.empty(), o.aux,   o.water};
  if (memory > 0 && reads_by_parts(o.in)) return fill_stream(o, request, memory, shell);

  const Run run = shell.run();
  DemFile file = read_dem(o.in, o.read, run.part(0, 0.2));
  if (count(file.dem.known) == 0)
    throw IoError(o.in, "no known cell; at least one is needed to fill the others");
  warn_of_outliers(file.dem, shell);
  const FillOutcome out = fill_holes_of(file.dem, request, run.part(0.2, 0.8));

  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  write.metadata = making(o, chosen, out, shell);
  if (!o.sigma.empty()) {
    Dem sigma = file.dem;
    sigma.z = out.sigma;
    write_dem(o.sigma, sigma, sigma_source(file.source), layer_options(shell.overwrite),
              run.part(0.8, 0.85));
  }
  if (!o.origin.empty()) {
    Dem kinds{Raster<float>(file.dem.size()), Mask(file.dem.size(), 1), file.dem.ref,
              file.dem.spacing};
    std::ranges::copy(out.origin.cells(), kinds.z.cells().begin());
    write_dem(o.origin, kinds, origin_source(file.source), origin_options(shell.overwrite),
              run.part(0.85, 0.87));
  }
  if (!o.table.empty()) write_table(o, out, shell.overwrite);
  write_dem(o.out, file.dem, file.source, write, run.part(0.87, 1));
  report(o, chosen, out, file.source.type, shell);
  return exit_code(out);
}

std::vector<std::string> type_names() {
  std::vector<std::string> names;
  for (const auto& [name, type] : kTypes) names.push_back(name);
  return names;
}

std::string method_names() {
  std::vector<std::string> names;
  for (const auto& m : all_fill_methods()) names.push_back(m.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_write_options(CLI::App& app, WriteOptions& write) {
  const char* group = "Writing";
  app.add_option("--format", write.format, "GDAL driver name, HGT or image; else by extension")
      ->type_name("NAME")
      ->group(group);
  app.add_option_function<std::string>(
         "--type",
         [&write](const std::string& name) {
           for (const auto& [text, type] : kTypes)
             if (text == name) write.type = type;
         },
         "int8 uint8 int16 uint16 int32 uint32 float32 float64; else as IN")
      ->check(suggests(type_names()))
      ->check([](const std::string& name) {
        for (const auto& [text, type] : kTypes)
          if (text == name) return std::string();
        return name +
               " is no cell type; must be int8, uint8, int16, uint16, int32, uint32, float32 or "
               "float64";
      })
      ->type_name("TYPE")
      ->group(group);
  app.add_option_function<double>(
         "--out-nodata", [&write](double v) { write.nodata = v; },
         "the no-data value that OUT declares; else as IN")
      ->check(takes("number"))
      ->type_name("VALUE")
      ->group(group);
}

}  // namespace

void add_fill(CLI::App& app, Shell& shell) {
  const auto o = std::make_shared<Options>();
  auto* verb = add_verb(
      app, shell, "fill", "Fill the holes of a DEM; known cells stay as they are, bit for bit",
      "  dem fill N36E008.hgt filled.hgt\n"
      "  dem fill sparse.tif filled.tif --sigma sigma.tif           # and how sure each cell is\n"
      "  dem fill sparse.tif rough.tif --roughness auto --seed 7    # as rough as the terrain\n"
      "  dem fill coast.tif filled.tif --method mcmd --inner-only   # fast; not the border's "
      "voids\n"
      "Methods: " +
          method_names() + " (their settings: dem methods NAME)\n" + HoleChoice::condition_help(),
      [o, &shell] { return fill(*o, shell); });
  verb->add_option("IN", o->in, "a DEM with holes, anything GDAL opens")
      ->required()
      ->check(takes("raster"))
      ->type_name("");
  verb->add_option("OUT", o->out, "the filled DEM; the format follows the extension")
      ->required()
      ->check(takes("new raster"))
      ->type_name("");
  verb->add_option("-m,--method", o->method, "how to fill, NAME or NAME:PRESET")
      ->check(suggests(names_and_presets(all_fill_methods())))
      ->type_name("NAME")
      ->capture_default_str();
  verb->add_option("-s,--set", o->set, "a setting of the method; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  verb->add_option("--sigma", o->sigma, "also write the standard deviation of each cell, in metres")
      ->check(takes("new raster"))
      ->type_name("FILE");
  verb->add_option("--roughness", o->roughness,
                   "gaps as rough as the terrain around (auto), or VALUE times that")
      ->type_name("auto|VALUE");
  verb->add_option("--realisation", o->realisation,
                   "the K-th random surface through the data, as rough as the terrain")
      ->check(CLI::Range(1, 1000000).description(""))
      ->type_name("K");
  verb->add_option("--seed", o->seed, "of random numbers")->type_name("N");
  verb->add_option("--source", o->origin,
                   "also write where each cell comes from: measured, method, aux, water")
      ->check(takes("new raster"))
      ->type_name("FILE");
  verb->add_option("--report-holes", o->table,
                   "also write a JSON table of holes, with errors of hidden rim cells")
      ->check(takes("new file"))
      ->type_name("FILE");
  verb->add_option("--aux", o->aux,
                   "a DEM to fill over; each hole takes the best of several, or none")
      ->check(takes("raster"))
      ->allow_extra_args(false)
      ->type_name("DEM");
  verb->add_option("--water", o->water, "polygons of lakes: flat where unknown, their shores above")
      ->check(takes("vector"))
      ->type_name("FILE");
  verb->add_flag("--whole", o->whole,
                 "as one problem, not hole by hole; so by itself above 25 % unknown");
  verb->add_option("--memory", o->memory,
                   "part by part within so much memory: 2G, 500M (GeoTIFF, VRT ...)")
      ->type_name("SIZE");
  verb->add_flag("--resume", o->resume,
                 "keep a journal; the same command goes on where it was stopped");
  o->choice.add_options(*verb);
  add_read_options(*verb, o->read);
  add_write_options(*verb, o->write);
}

}  // namespace dem::app
