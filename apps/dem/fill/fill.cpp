// dem fill: fill the holes of a DEM.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <tuple>

#include "dem/io/methods.h"
#include "fill/hole_fill.h"
#include "fill/stream_fill.h"
#include "report/fill_report.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string in, out, sigma;
  std::optional<int> realisation;
  std::string roughness;  // "auto" or a number
  std::optional<std::uint64_t> seed;
  std::string method{default_fill_method()};
  std::vector<std::string> set;
  std::string origin, table, memory, water, report;
  std::vector<std::string> aux;
  bool resume = false;
  int task = 0, tasks = 0;  // --task; 0: not given
  bool whole = false;
  HoleChoice choice;
  ReadOptions read;
  WriteOptions write;
};

/// Adds a setting that an option of its own stands for, unless it is among the settings already.
void add_setting(ChosenMethod& chosen, const std::string& name, const std::string& value,
                 const std::string& option) {
  if (!chosen.method->has_setting(name))
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
  chosen.check();
  if (!o.sigma.empty() && !chosen.gives_sigma())
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
  return "written as " + cell_type_names()[std::size_t(*o.write.type)];
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
    if (chosen.method->traits.for_contours && !out.contour_lines)
      shell.say("{}: the known cells are no contour lines; the spline filled the rest", o.method);
  }
  for (const auto& fit : out.aux)
    if (!fit.warning.empty()) shell.say("warning: {} {}", fit.path, fit.warning);
  Json json{{"output", o.out}};
  json.update(as_json(out, o.method, chosen.settings));
  shell.print(json, "");
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

/// Whatever the raster: its sections were made before the output was written, so that a stop while
/// they are made leaves the output as it was.
void write_page(const Options& o, const ChosenMethod& chosen, const FillOutcome& out, Json sections,
                const Stopwatch& watch, Shell& shell) {
  if (o.report.empty()) return;
  ReportPage page = fill_page(o.in, chosen, out);
  page.sections = std::move(sections);
  page.making.insert(page.making.begin() + 1, {"output", o.out});
  write_report(o.report, page, watch, shell);
}

int exit_code(const FillOutcome& out) {
  if (!out.known_kept) return kCheckFailed;
  return out.left > 0 ? kUnfilled : kDone;
}

/// A task leaves its cells in its journal; another run writes the output.
int report_task(const Options& o, const FillOutcome& out, Shell& shell) {
  shell.say(
      "task {} of {}: filled {} cells in {} window{}, {:.3f} s; when all tasks are done, the same "
      "command with --resume for --task writes {}",
      o.task, o.tasks, grouped(out.filled), grouped(out.windows), out.windows == 1 ? "" : "s",
      out.seconds, o.out);
  shell.print({{"output", o.out},
               {"task", o.task},
               {"tasks", o.tasks},
               {"windows", out.windows},
               {"filled", out.filled},
               {"seconds", out.seconds}},
              "");
  return kDone;
}

/// Strip by strip, within a bound of memory.
int fill_stream(const Options& o, const FillRequest& request, std::size_t memory, Shell& shell) {
  const Run run = shell.run();
  Stopwatch watch;
  StreamFill::Options options{o.in, o.out, o.read, memory, o.task, o.tasks, o.resume, ""};
  for (const auto& part : {o.method, settings_text(request.method.settings), o.choice.text(),
                           o.sigma, o.table, std::string(o.whole ? "whole" : ""), o.memory, o.water,
                           fmt::format("{}", fmt::join(o.aux, " "))})
    options.settings += part + " | ";
  StreamFill job(options, request, run.part(0, 0.65));
  FillOutcome& out = job.outcome();
  if (job.resumed_windows() > 0)
    shell.say("resumed: {} of {} windows were done", grouped(job.resumed_windows()),
              grouped(out.windows));
  if (o.tasks) return report_task(o, out, shell);

  watch.lap("finding holes and filling");
  Json sections;
  if (!o.report.empty()) {
    const auto read = [&](const Box& box) { return job.read(box); };
    sections = fill_sections(out, o.method, {job.size(), job.ref(), read}, run.part(0.65, 0.7));
    watch.lap("drawing");
  }

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
  watch.lap("writing");
  write_page(o, request.method, out, std::move(sections), watch, shell);
  report(o, request.method, out, job.source().type, shell);
  return exit_code(out);
}

/// The bytes that may be used when the raster is to be worked on part by part; 0: as a whole.
std::size_t stream_memory(const Options& o) {
  if (!o.memory.empty()) return parse_memory("memory", o.memory);
  return o.resume || o.tasks ? machine_memory() / 2 : 0;
}

/// "3/8".
std::pair<int, int> parse_task(const std::string& text) {
  int task = 0, tasks = 0, used = 0;
  if (std::sscanf(text.c_str(), "%6d/%6d%n", &task, &tasks, &used) != 2 ||
      std::size_t(used) != text.size() || task < 1 || tasks < task || tasks > 100000)
    throw std::invalid_argument(fmt::format(
        "task = {}; must be I/N, two whole numbers with 1 <= I <= N <= 100000, e.g. 3/8", text));
  return {task, tasks};
}

int fill(const Options& o, Shell& shell) {
  if (o.tasks && o.resume)
    throw std::invalid_argument(
        "--task goes on by itself where it was stopped: no --resume beside it");
  const ChosenMethod chosen = choose(o);
  check(o.choice);
  const std::size_t memory = stream_memory(o);
  for (const std::string& path : {o.out, o.sigma, o.origin, o.table})
    if (!path.empty()) check_writable(path, shell.overwrite);
  check_report(o.report, shell.overwrite);

  const FillRequest request{chosen,
                            o.choice,
                            o.whole,
                            !o.table.empty(),
                            !o.sigma.empty(),
                            !o.origin.empty() || !o.report.empty(),
                            o.aux,
                            o.water};
  if (memory > 0) return fill_stream(o, request, memory, shell);

  const Run run = shell.run();
  Stopwatch watch;
  DemFile file = read_dem(o.in, o.read, run.part(0, 0.2));
  if (count(file.dem.known) == 0)
    throw IoError(o.in, "no known cell; at least one is needed to fill the others");
  warn_of_outliers(file.dem, shell);
  watch.lap("reading");
  const FillOutcome out = fill_holes_of(file.dem, request, run.part(0.2, 0.75));
  watch.lap("finding holes and filling");
  Json sections;
  if (!o.report.empty()) {
    sections = fill_sections(out, o.method, filled_raster(file.dem, out), run.part(0.75, 0.8));
    watch.lap("drawing");
  }

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
  watch.lap("writing");
  write_page(o, chosen, out, std::move(sections), watch, shell);
  report(o, chosen, out, file.source.type, shell);
  return exit_code(out);
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
           apply({{"type", name}}, fields(write));
         },
         "int8 uint8 int16 uint16 int32 uint32 float32 float64; else as IN")
      ->check(suggests(cell_type_names()))
      ->check([](const std::string& name) {
        if (std::ranges::find(cell_type_names(), name) != cell_type_names().end())
          return std::string();
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
      "  dem fill tiles/ filled/ --memory 2G                        # a folder of .hgt tiles\n"
      "  dem fill sparse.tif filled.tif --report filled.html        # a page to look at\n"
      "Methods: " +
          method_names() + " (their settings: dem methods NAME)\n" + HoleChoice::condition_help(),
      [o, &shell] { return fill(*o, shell); });
  verb->add_option("IN", o->in, "a DEM with holes, anything GDAL opens; or a folder of tiles")
      ->required()
      ->check(takes("raster"))
      ->type_name("");
  verb->add_option("OUT", o->out,
                   "by extension; NAME.vrt: tiles of GeoTIFF; FOLDER/: tiles of .hgt")
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
      ->check(takes("number"))
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
  add_report_option(*verb, o->report);
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
  verb->add_option_function<std::string>(
          "--task",
          [o](const std::string& text) { std::tie(o->task, o->tasks) = parse_task(text); },
          "the I-th of N shares, into a journal; after all, --resume writes OUT")
      ->type_name("I/N");
  o->choice.add_options(*verb);
  add_read_options(*verb, o->read);
  add_write_options(*verb, o->write);
}

}  // namespace dem::app
