// dem curve: error and time of every method against the share of cells kept.

#include <filesystem>

#include "curve/budget.h"
#include "curve/experiment.h"
#include "report/curve_report.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string truth, dir, report;
  std::vector<std::string> rivals;
  CurveOptions curve;
  BudgetOptions budget;  // when an error is wanted
  ReadOptions read;
};

/// How many cells each way of choosing them needs for the wanted errors.
int budget(const Options& given, Shell& shell) {
  BudgetOptions o = given.budget;
  if (given.curve.methods != CurveOptions().methods) {
    if (given.curve.methods.size() != 1)
      throw std::invalid_argument("--budget takes one method: --methods NAME");
    o.method = given.curve.methods.front();
  }
  if (given.curve.percents != CurveOptions().percents) o.percents = given.curve.percents;
  o.seed = given.curve.seed;
  check(o);
  check_report(given.report, shell.overwrite);
  const OutputFolder folder(given.dir);
  for (const char* name : kBudgetFiles) check_writable(folder.file(name), shell.overwrite);
  const Run run = shell.run();
  Stopwatch watch;
  const DemFile file = read_dem(given.truth, given.read, run.part(0, 0.02));
  if (count(file.dem.known) < 16)
    throw IoError(given.truth, "fewer than sixteen known cells; nothing to choose from");
  watch.lap("reading");
  const auto points = measure_budget(file.dem, o, run.part(0.02, 1));
  watch.lap("measuring");
  const std::string title =
      "Cells to keep of " + std::filesystem::path(given.truth).filename().string();
  const Json json = write_budget(folder, title, file.dem, o, points, shell.overwrite);
  if (!given.report.empty())
    write_report(given.report, budget_page(given.truth, file.dem, o, points), watch, shell);
  shell.print(json, budget_table(file.dem, o, points));
  shell.say("wrote {}, {}, {}", folder.file("budget.csv"), folder.file("budget.json"),
            folder.file("budget.svg"));
  return kDone;
}

int curve(const Options& o, Shell& shell) {
  if (!o.budget.rmse_m.empty()) return budget(o, shell);
  check(o.curve);
  CurveOptions options = o.curve;
  for (const auto& path : o.rivals) {
    const auto scores = read_rivals(path);
    options.rivals.insert(options.rivals.end(), scores.begin(), scores.end());
  }
  check_report(o.report, shell.overwrite);
  const OutputFolder folder(o.dir);
  for (const char* name : kCurveFiles) check_writable(folder.file(name), shell.overwrite);

  const Run run = shell.run();
  Stopwatch watch;
  const DemFile file = read_dem(o.truth, o.read, run.part(0, 0.02));
  if (count(file.dem.known) < 2)
    throw IoError(o.truth, "fewer than two known cells; nothing to remove");
  watch.lap("reading");
  const auto scores = measure_curve(file.dem, options, run.part(0.02, 1));
  watch.lap("measuring");
  const std::string title = "Filling " + std::filesystem::path(o.truth).filename().string();
  Json json = write_curve(folder, title, file.dem, options, scores, shell.overwrite);
  if (!o.report.empty())
    write_report(o.report, curve_page(o.truth, file.dem, options, scores), watch, shell);

  json["files"] = Json::array();
  for (const char* name : kCurveFiles) json["files"].push_back(folder.file(name));
  shell.print(json, curve_table(scores, options));
  shell.say("wrote {}, {}, {}", folder.file("curves.csv"), folder.file("curves.json"),
            folder.file("curves.svg"));
  return kDone;
}

}  // namespace

void add_curve(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb = program.add(
      "curve", kMeasure,
      "Measure the error and time of fill methods for several shares of known cells",
      "  dem curve whole.tif results\n"
      "  dem curve whole.tif results --methods mcmd,mcmd:paper,idw --rates 50,10,3.4,1\n"
      "  dem curve N44W072.hgt results --repeats 1 --overwrite\n"
      "  dem curve whole.tif results --budget 5,10 --methods spline");
  verb.work = [o, &shell] { return curve(*o, shell); };
  verb.argument("TRUTH", o->truth, "DEM without voids, or with few").kind("raster").must_be_given();
  verb.argument("DIR", o->dir, "Folder for curves.csv, curves.json and curves.svg")
      .kind("new folder")
      .must_be_given();
  verb.option("-m,--methods", o->curve.methods, "A,B,C",
              "Names of fill methods, separated by commas (all of them)")
      .by_commas();
  verb.option("-r,--rates", o->curve.percents, "P,P,P",
              "Percentages of the cells that are kept, separated by commas")
      .by_commas()
      .show_default();
  verb.option("--budget", o->budget.rmse_m, "M,M",
              "Measure instead how many cells each way of sampling needs for these RMSE in metres")
      .by_commas();
  verb.option("--repeats", o->curve.repeats, "N",
              "Number of runs of each measurement; the median time is reported")
      .within(1, 1000)
      .show_default();
  verb.option("--rivals", o->rivals, "FILE",
              "Scores of other programs, from scripts/compare.py, to be drawn too")
      .kind("file");
  verb.option("--seed", o->curve.seed, "N", "Random seed for the choice of cells").show_default();
  add_report_option(verb, o->report);
  add_read_options(verb, o->read);
}

}  // namespace dem::app
