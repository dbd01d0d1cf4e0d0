// dem fill: fill the holes of a DEM.

#include <algorithm>
#include <cstdio>
#include <optional>
#include <tuple>

#include "dem/io/fill_job.h"
#include "dem/io/methods.h"
#include "fill/fill_json.h"
#include "report/fill_report.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string in, out, sigma;  // in: the files, a line each
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
  std::string region;
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
  if (o.realisation)
    add_setting(chosen, "realisation", std::to_string(*o.realisation), "--realisation");
  if (!o.roughness.empty()) {
    add_setting(chosen, "realisation", "1", "--roughness");
    if (o.roughness != "auto") add_setting(chosen, "roughness", o.roughness, "--roughness");
  }
  if (o.seed) add_setting(chosen, "seed", std::to_string(*o.seed), "--seed");
  chosen.check();
  return chosen;
}

std::string settings_text(const Settings& settings) {
  std::string text;
  for (const auto& [key, value] : settings) text += (text.empty() ? "" : " ") + key + "=" + value;
  return text;
}

/// What became of the known cells: in another type they need not be the same.
std::string known_cells(const Options& o, const FillReport& report, CellType type) {
  if (!report.known_kept) return "CHANGED";
  const std::string sum = fmt::format(" (checksum {:016x})", report.known_checksum);
  if (!o.write.type || *o.write.type == type) return "unchanged" + sum;
  return "written as " + cell_type_names()[std::size_t(*o.write.type)];
}

void say_what_was_filled(const Options& o, const FillJob& job, Shell& shell) {
  const FillReport& report = job.report();
  std::string left = left_text(job.plan());
  if (report.left) left += fmt::format(", {} left unfilled", grouped(report.left));
  if (report.memory_needed)
    left += fmt::format(" (--memory {}M would do)", (report.memory_needed >> 20) + 1);
  if (report.guide_cells)
    left += fmt::format(", {} over an auxiliary DEM", grouped(report.guide_cells));
  if (report.water_cells) left += fmt::format(", {} flat as water", grouped(report.water_cells));
  shell.say(
      "filled {} of {} unknown cells ({} of {} voids touch the border: {} cells){}; {}, {} "
      "window{}, {:.3f} s; known cells {}: {}",
      grouped(report.filled), grouped(report.unknown), grouped(report.border_holes),
      grouped(job.plan().holes.size()), grouped(report.border_cells), left, o.method,
      grouped(report.windows), report.windows == 1 ? "" : "s", report.seconds,
      known_cells(o, report, job.source().type), o.out);
}

void report(const Options& o, const FillJob& job, Shell& shell) {
  const FillReport& report = job.report();
  const ChosenMethod& chosen = job.options().method;
  if (report.unknown == 0) {
    shell.say("all cells are known: {} is a copy of {}", o.out, o.in);
  } else {
    say_what_was_filled(o, job, shell);
    if (chosen.method->traits.for_contours && !report.contour_lines)
      shell.say("{}: the known cells are no contour lines; the spline filled the rest", o.method);
  }
  for (const auto& fit : report.guides)
    if (!fit.warning.empty()) shell.say("warning: {} {}", fit.name, fit.warning);
  Json json{{"output", o.out}};
  json.update(as_json(job.plan(), report, chosen, o.method));
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
std::vector<std::pair<std::string, std::string>> making(const Options& o, const FillJob& job,
                                                        const Shell& shell) {
  if (job.report().unknown == 0 || !holds_metadata(o.out, o.write.format)) return {};
  return {{"DEM_INPUT", o.in},
          {"DEM_COMMAND", shell.command},
          {"DEM_METHOD", o.method},
          {"DEM_SETTINGS", settings_text(job.options().method.settings)},
          {"DEM_KNOWN_CHECKSUM", fmt::format("{:016x}", job.report().known_checksum)},
          {"DEM_VERSION", DEM_VERSION}};
}

void write_table(const Options& o, const FillJob& job, bool overwrite) {
  const Json table{{"input", o.in},
                   {"output", o.out},
                   {"holes", hole_table(job.plan(), job.report(), o.method)}};
  write_text(o.table, table.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", overwrite);
}

void write_outputs(const Options& o, FillJob& job, Shell& shell, const Run& run) {
  WriteOptions write = o.write;
  write.overwrite = shell.overwrite;
  write.metadata = making(o, job, shell);
  if (!o.sigma.empty())
    job.write(o.sigma, FillLayer::sigma, sigma_source(job.source()), layer_options(shell.overwrite),
              run.part(0, 0.3));
  if (!o.origin.empty())
    job.write(o.origin, FillLayer::origin, origin_source(job.source()),
              origin_options(shell.overwrite), run.part(0.3, 0.45));
  if (!o.table.empty()) write_table(o, job, shell.overwrite);
  job.write(o.out, FillLayer::heights, job.source(), write, run.part(0.45, 1));
  job.finish();
}

/// Whatever the raster: its sections were made before the output was written, so that a stop while
/// they are made leaves the output as it was.
void write_page(const Options& o, const FillJob& job, Json sections, const Stopwatch& watch,
                Shell& shell) {
  if (o.report.empty()) return;
  ReportPage page = fill_page(o.in, job);
  page.sections = std::move(sections);
  page.making.insert(page.making.begin() + 1, {"output", o.out});
  write_report(o.report, page, watch, shell);
}

int exit_code(const FillReport& report) {
  if (!report.known_kept) return kCheckFailed;
  return report.left > 0 ? kUnfilled : kDone;
}

/// A task leaves its cells in its journal; another run writes the output.
int report_task(const Options& o, const FillReport& report, Shell& shell) {
  shell.say(
      "task {} of {}: filled {} cells in {} window{}, {:.3f} s; when all tasks are done, the same "
      "command with --resume for --task writes {}",
      o.task, o.tasks, grouped(report.filled), grouped(report.windows),
      report.windows == 1 ? "" : "s", report.seconds, o.out);
  shell.print({{"output", o.out},
               {"task", o.task},
               {"tasks", o.tasks},
               {"windows", report.windows},
               {"filled", report.filled},
               {"seconds", report.seconds}},
              "");
  return kDone;
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

FillJob::Options job_options(const Options& o) {
  FillJob::Options options;
  options.read = o.read;
  options.fill = checked({.method = choose(o),
                          .holes = o.choice,
                          .whole = o.whole,
                          .sigma = !o.sigma.empty(),
                          .rim_errors = !o.table.empty()});
  options.files = {o.aux, o.water, o.region};
  if (!o.memory.empty()) options.memory = parse_memory("memory", o.memory);
  options.out = o.out;
  options.resume = o.resume;
  options.task = o.task;
  options.tasks = o.tasks;
  return options;
}

int fill(const Options& o, Shell& shell) {
  if (o.tasks && o.resume)
    throw std::invalid_argument(
        "--task goes on by itself where it was stopped: no --resume beside it");
  const FillJob::Options options = job_options(o);
  WriteOptions as_asked = o.write;
  as_asked.overwrite = shell.overwrite;
  check_writable(o.out, as_asked);
  for (const std::string& path : {o.sigma, o.origin, o.table})
    if (!path.empty()) check_writable(path, shell.overwrite);
  check_report(o.report, shell.overwrite);

  const Run run = shell.run();
  Stopwatch watch;
  FillJob job(o.in, options, run.part(0, 0.2));
  if (job.held()) warn_of_outliers(*job.held(), shell);
  watch.lap("reading");
  job.fill(run.part(job.held() ? 0.2 : 0, 0.7));
  if (job.report().resumed_windows > 0)
    shell.say("resumed: {} of {} windows were done", grouped(job.report().resumed_windows),
              grouped(job.report().windows));
  watch.lap("finding holes and filling");
  if (o.tasks) return report_task(o, job.report(), shell);

  Json sections;
  if (!o.report.empty()) {
    sections = fill_sections(job, o.method, run.part(0.7, 0.75));
    watch.lap("drawing");
  }
  write_outputs(o, job, shell, run.part(0.75, 1));
  watch.lap("writing");
  write_page(o, job, std::move(sections), watch, shell);
  report(o, job, shell);
  return exit_code(job.report());
}

std::string method_names() {
  std::vector<std::string> names;
  for (const auto& m : all_fill_methods()) names.push_back(m.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// How conditions are written, for the help.
std::string condition_help() {
  std::string text = "Conditions: \"area_km2 < 5 and not at_border\", of";
  std::size_t width = text.size();
  for (const HoleFact& fact : hole_facts()) {
    if (width + fact.name.size() > 96) text += "\n ", width = 2;
    text += " " + fact.name;
    width += fact.name.size() + 1;
  }
  return text + "\n";
}

void add_hole_options(Command& verb, HoleChoice& choice, std::string& region) {
  verb.heading("Which voids (all by default)");
  verb.flag("--inner-only", choice.inner_only, "Leave voids that touch the border of the raster");
  verb.option("--max-area-km2", choice.max_area_km2, "A",
              "Fill only voids up to this area on the ground")
      .above(0);
  verb.option("--max-distance-m", choice.max_distance_m, "D",
              "Fill only voids where no cell is farther than this from the nearest known cell")
      .above(0);
  verb.option("--min-cells", choice.min_cells, "N",
              "Fill only voids with at least this number of cells");
  verb.option("--where", choice.where, "CONDITION",
              "Fill only voids that meet a condition (see below)");
  verb.option("--region", region, "FILE",
              "Fill only voids with a cell in these polygons, in any format that OGR opens")
      .kind("vector");
  verb.heading("Options");
}

}  // namespace

void add_fill(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add(
      "fill", kEveryday, "Fill the voids of a DEM; known cells stay unchanged, bit for bit",
      "  dem fill N36E008.hgt filled.hgt\n"
      "  dem fill sparse.tif filled.tif --sigma sigma.tif           # with standard errors\n"
      "  dem fill *.hgt filled/ --memory 2G                         # tiles, filled as one DEM\n"
      "  dem fill sparse.tif filled.tif --report filled.html        # a page with pictures");
  verb.notes =
      "Methods: " + method_names() + " (their settings: dem methods NAME)\n" + condition_help();
  verb.work = [o, &shell] {
    o->in = fmt::format("{}", fmt::join(o->files, "\n"));
    return fill(*o, shell);
  };
  verb.argument(
          "IN", o->files,
          "DEM with voids, in any format that GDAL opens, or a folder of tiles; several files "
          "are tiles of one DEM")
      .kind("raster")
      .must_be_given();
  verb.argument("OUT", o->out,
                "Filled DEM, in the format of its extension; NAME.vrt for tiles of GeoTIFF, "
                "FOLDER/ for tiles of .hgt")
      .kind("new raster")
      .must_be_given();
  verb.option("-m,--method", o->method, "NAME", "Fill method, NAME or NAME:PRESET")
      .suggest(names_and_presets(all_fill_methods()))
      .show_default();
  add_set_option(verb, o->set, "method");
  verb.option("--sigma", o->sigma, "FILE", "Also write the standard error of each cell in metres")
      .kind("new raster");
  verb.option(
      "--roughness", o->roughness, "auto|VALUE",
      "Make filled cells as rough as the terrain around them (auto), or VALUE times as rough");
  verb.option("--realisation", o->realisation, "K",
              "Make the K-th of many random surfaces that pass through the known cells and are as "
              "rough as the terrain")
      .within(1, 1000000);
  verb.option("--seed", o->seed, "N", "Random seed for --roughness and --realisation");
  verb.option("--source", o->origin, "FILE",
              "Also write where each height comes from: measured, method, auxiliary DEM or water")
      .kind("new raster");
  verb.option(
          "--report-holes", o->table, "FILE",
          "Also write a JSON table of the holes, with the errors of hidden cells on their edges")
      .kind("new file");
  add_report_option(verb, o->report);
  verb.option("--aux", o->aux, "DEM",
              "Auxiliary DEM that gives the shape of filled cells; may be repeated, and each hole "
              "takes the one that fits best, or none")
      .kind("raster");
  verb.option("--water", o->water, "FILE",
              "Polygons of lakes, which are filled flat and below their shores")
      .kind("vector");
  verb.flag("--whole", o->whole,
            "Fill the whole raster at once instead of hole by hole (automatic when more than 25 % "
            "of the cells are nodata)");
  verb.option("--memory", o->memory, "SIZE",
              "Work part by part within this amount of memory, for example 2G or 500M");
  verb.flag("--resume", o->resume,
            "Keep a journal, from which the same command goes on after it was stopped");
  verb.option_read_by(
      "--task", [o](const std::string& text) { std::tie(o->task, o->tasks) = parse_task(text); },
      "I/N", "Fill the I-th of N shares of the holes; after all of them --resume writes OUT");
  add_hole_options(verb, o->choice, o->region);
  add_read_options(verb, o->read);
  add_write_options(verb, o->write);
}

}  // namespace dem::app
