// The Mount Washington experiment of [belhadj2007], section 4 and figures 9 and 10.

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "curve/experiment.h"
#include "dem/io/geodesy.h"
#include "dem/sample.h"
#include "dem/spline.h"
#include "reproduce/reproduce.h"

namespace dem::app {
namespace {

constexpr int kPaperSide = 1025;
constexpr std::size_t kPaperKept = 35721;
constexpr double kPaperRmse = 5.8, kPaperUp = 2.73, kPaperDown = 0.24;

/// Other programs on mtwashington_1025_3s.tif with the same cells kept, measured once:
///   scripts/compare.py mtwashington_1025_3s.tif DIR --sample="--keep 3.4%"
/// Times are CPU seconds, start, reading and writing included. GMT 6.4, SAGA 8.5, GDAL 3.6.
struct Rival {
  const char* name;
  double percent, rmse_m, cpu_s;
};
constexpr Rival kRivals[] = {
    {"gmt surface -A", 50, 2.54, 2.1},     {"gmt surface -A", 10, 8.07, 7.6},
    {"gmt surface -A", 3.4, 17.25, 9.7},   {"gmt surface -A", 1, 34.98, 12.2},
    {"saga close gaps", 50, 5.71, 9.1},    {"saga close gaps", 10, 16.76, 48.9},
    {"saga close gaps", 3.4, 30.05, 31},   {"saga close gaps", 1, 50.54, 39},
    {"gdal_fillnodata", 50, 6.80, 0.27},   {"gdal_fillnodata", 10, 13.99, 0.33},
    {"gdal_fillnodata", 3.4, 24.17, 0.53}, {"gdal_fillnodata", 1, 41.45, 0.57}};

/// The rivals' scores; none for another DEM than theirs.
std::vector<Score> rivals_on(const std::string& path) {
  std::vector<Score> scores;
  if (std::filesystem::path(path).filename() != "mtwashington_1025_3s.tif") return scores;
  for (const Rival& r : kRivals) {
    scores.push_back({r.name, r.percent, 0, {}, {r.cpu_s, r.cpu_s}});
    scores.back().errors.rmse_m = r.rmse_m;
  }
  return scores;
}

struct Halves {
  Raster<float> z;
  Times up, down;
};

/// MCMD in its two halves, each timed: what the paper calls MDBU and MD.
Halves fill_in_halves(const Dem& sampled, const McmdOptions& o, int repeats, const Run& run) {
  const MdOptions md{.subdivision = o.subdivision,
                     .I = o.I,
                     .I_ridge = o.I_ridge,
                     .I_river = o.I_river,
                     .datum_m = o.datum_m,
                     .H = o.H,
                     .rt = o.rt,
                     .rs = o.rs,
                     .seed = o.seed};
  const auto [carried, up] = timed(repeats, [&] { return carry_up_mcmd(sampled, o, run); });
  auto [z, down] = timed(repeats, [&, &from = carried] { return fill_md(from, md, run); });
  return {std::move(z), up, down};
}

double largest_difference(const Raster<float>& a, const Raster<float>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.cells().size(); ++i)
    most = std::max(most, std::abs(double(a.cells()[i]) - double(b.cells()[i])));
  return most;
}

std::string find_tile(const ReproduceOptions& o) {
  if (!o.tile.empty()) return o.tile;
  const std::string path = find_data(o, {"mtwashington_1025_3s.tif", "N44W072.hgt"});
  if (path.empty())
    throw IoError(
        "N44W072.hgt",
        "not in --data, $DEM_TESTDATA or ../shared/data; it is public SRTM, to be had from "
        "viewfinderpanoramas or USGS EarthExplorer; --tile FILE runs the experiment on any other "
        "DEM, the tile in testdata included");
  return path;
}

void measure(Findings& f, const std::string& name, const Dem& truth, const Dem& sampled,
             const ReproduceOptions& o, const std::string& picture, const Run& run,
             bool overwrite) {
  const McmdOptions options = mcmd_options(name);
  const Halves halves = fill_in_halves(sampled, options, o.repeats, run);
  const auto spacing = spacing_by_row(truth.ref, truth.size());
  const Errors errors =
      compare(completed(truth, halves.z), halves.z, removed_cells(truth, sampled), spacing);
  f.numbers.push_back({name + ": RMSE over the removed cells", "m", kPaperRmse, errors.rmse_m});
  f.numbers.push_back({name + ": bottom-up time (MDBU)", "s", kPaperUp, halves.up.wall_s});
  f.numbers.push_back({name + ": top-down time (MD)", "s", kPaperDown, halves.down.wall_s});
  f.numbers.push_back(
      {name + ": time", "s", kPaperUp + kPaperDown, halves.up.wall_s + halves.down.wall_s});
  if (!std::isfinite(errors.rmse_m)) f.failures.push_back(name + ": RMSE is not a number");
  if (largest_difference(halves.z, fill_mcmd(sampled, options, run)) > 0.01)  // rounding is 0.001
    f.failures.push_back(name + ": the two halves differ from the whole");
  draw(f, picture, halves.z, truth.spacing, overwrite);
}

/// The most accurate method, which the paper does not have: its future work.
void measure_spline(Findings& f, const Dem& truth, const Dem& sampled, const ReproduceOptions& o,
                    const std::string& picture, const Run& run, bool overwrite) {
  const auto [filled, times] = timed(o.repeats, [&] { return fill_spline(sampled, {}, run); });
  const auto spacing = spacing_by_row(truth.ref, truth.size());
  const Errors errors =
      compare(completed(truth, filled.z), filled.z, removed_cells(truth, sampled), spacing);
  f.numbers.push_back({"spline: RMSE over the removed cells", "m", kPaperRmse, errors.rmse_m});
  f.numbers.push_back({"spline: time", "s", kPaperUp + kPaperDown, times.wall_s});
  if (!std::isfinite(errors.rmse_m)) f.failures.push_back("spline: RMSE is not a number");
  draw(f, picture, filled.z, truth.spacing, overwrite);
}

}  // namespace

Findings reproduce_mount_washington(const ReproduceOptions& o, const OutputFolder& folder,
                                    Shell& shell) {
  const std::string pictures[] = {folder.file("truth.png"), folder.file("sampled.png"),
                                  folder.file("mcmd_paper.png"), folder.file("mcmd_default.png"),
                                  folder.file("spline.png")};
  for (const auto& path : pictures) check_writable(path, shell.overwrite);
  for (const char* name : kCurveFiles) check_writable(folder.file(name), shell.overwrite);
  const std::string path = find_tile(o);

  const Run run = shell.run();
  const DemFile file = read_tile(path, run.part(0, 0.02));
  const Dem truth = window_around_summit(file.dem, kPaperSide);
  const std::size_t known = count(truth.known), paper_cells = std::size_t(kPaperSide) * kPaperSide;
  const std::size_t kept =
      std::size_t(std::llround(double(known) * double(kPaperKept) / double(paper_cells)));
  if (known < 100)
    throw IoError(path, fmt::format("{} known cells; the experiment needs 100", known));
  const Dem sampled = sample_random(truth, kept);

  Findings f;
  draw(f, pictures[0], truth.z, truth.spacing, shell.overwrite);
  draw(f, pictures[1], truth.z, truth.spacing, shell.overwrite, sampled.known);
  measure(f, "mcmd:paper", truth, sampled, o, pictures[2], run.part(0.02, 0.05), shell.overwrite);
  measure(f, "mcmd", truth, sampled, o, pictures[3], run.part(0.05, 0.08), shell.overwrite);
  measure_spline(f, truth, sampled, o, pictures[4], run.part(0.08, 0.15), shell.overwrite);

  const auto spacing = truth.spacing;
  f.notes.push_back(fmt::format("{}: {} x {} cells around the summit, {} of {} kept ({}).", path,
                                truth.z.cols(), truth.z.rows(), grouped(kept), grouped(known),
                                percent_of(kept, known)));
  if (truth.size() != Size{kPaperSide, kPaperSide})
    f.notes.push_back(
        "Smaller than the paper's 1025 x 1025: all of it is used, at the paper's rate.");
  f.notes.push_back(fmt::format(
      "Data: the paper has a USGS DEM of the 10 m class (unit 0.019836 m); here cells are {:.0f} x "
      "{:.0f} m,",
      spacing.dx_m, spacing.dy_m));
  f.notes.push_back(
      "so RMSE in metres cannot be compared with the paper's; ratios between methods can.");

  CurveOptions curve;
  curve.repeats = o.repeats;
  curve.rivals = rivals_on(path);
  const auto scores = measure_curve(truth, curve, run.part(0.15, 1));
  f.extra["curve"] = write_curve(folder, "Mount Washington: error and time against cells kept",
                                 truth, curve, scores, shell.overwrite);
  f.table = curve_table(scores, curve);
  f.pictures.push_back(folder.file("curves.svg"));
  return f;
}

}  // namespace dem::app
