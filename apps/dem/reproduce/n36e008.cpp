// The SRTM experiment of [belhadj2007], figure 9 (c) to (e): keep silhouettes only, rebuild, and
// fill the real voids.

#include <cmath>
#include <filesystem>
#include <iterator>

#include "dem/evaluate.h"
#include "dem/holes.h"
#include "dem/io/geodesy.h"
#include "dem/io/methods.h"
#include "dem/sample.h"
#include "reproduce/reproduce.h"

namespace dem::app {
namespace {

constexpr double kShare = 0.095;  // the paper: "more than 90 % of data are deleted"
constexpr double kPaperRmse = 8;  // "less than 8 meters"

std::string find_tile(const ReproduceOptions& o) {
  if (!o.tile.empty()) return o.tile;
  const std::string path = find_data(o, {"N36E008.hgt", "N42E001.void.hgt", "N46E008.hgt"});
  if (path.empty())
    throw IoError("N36E008.hgt",
                  "neither it nor N42E001.void.hgt nor N46E008.hgt is in --data, $DEM_TESTDATA or "
                  "../shared/data; it is public SRTM, to be had from viewfinderpanoramas or USGS "
                  "EarthExplorer; --tile FILE runs the experiment on any other DEM");
  return path;
}

/// N42E001.void.hgt -> N42E001.filled.hgt, when that is there.
std::string filled_edition(const std::string& path) {
  const auto at = path.rfind(".void.");
  if (at == std::string::npos) return "";
  const std::string other = path.substr(0, at) + ".filled." + path.substr(at + 6);
  std::error_code error;
  return std::filesystem::exists(other, error) ? other : "";
}

Errors errors_over(const Dem& truth, const Raster<float>& got, const Mask& where) {
  return compare(completed(truth, got), got, where, spacing_by_row(truth.ref, truth.size()));
}

void add(Findings& f, const std::string& what, std::optional<double> paper, double rmse) {
  f.numbers.push_back({what, "m", paper, rmse});
  if (!std::isfinite(rmse)) f.failures.push_back(what + " is not a number");
}

}  // namespace

Findings reproduce_n36e008(const ReproduceOptions& o, const OutputFolder& folder, Shell& shell) {
  const std::string original = folder.file("original.png"), edges = folder.file("edges.png");
  const std::pair<std::string, std::string> methods[] = {
      {"mcmd:paper", "mcmd_paper"}, {"mcmd", "mcmd_default"}, {"spline", "spline"}};
  for (const auto& path : {original, edges}) check_writable(path, shell.overwrite);
  for (const auto& [name, file] : methods)
    for (const char* what : {"rebuilt_", "voids_"})
      check_writable(folder.file(what + file + ".png"), shell.overwrite);
  const std::string path = find_tile(o);

  const Run run = shell.run();
  const Dem tile = read_tile(path, run.part(0, 0.1)).dem;
  const std::size_t known = count(tile.known);
  if (known < 100)
    throw IoError(path, fmt::format("{} known cells; the experiment needs 100", known));
  const std::size_t kept = std::size_t(std::llround(kShare * double(known)));
  run.report(0.1, "Sobel edges");
  const Dem sampled = sample_edges(tile, kept);
  const VoidSummary voids = void_summary(tile.known);

  Findings f;
  draw(f, original, tile.z, tile.spacing, shell.overwrite, tile.known);
  draw(f, edges, tile.z, tile.spacing, shell.overwrite, sampled.known);
  f.notes.push_back(
      fmt::format("{}: {} of {} known cells kept ({}), where Sobel's gradient is strongest.", path,
                  grouped(kept), grouped(known), percent_of(kept, known)));
  f.notes.push_back(fmt::format("Voids: {} cells in {} voids, largest {}.", grouped(voids.cells),
                                grouped(voids.voids), grouped(voids.largest)));
  if (path.find("N36E008") == std::string::npos)
    f.notes.push_back(
        "Data: the paper has N36E008, hills in Tunisia; this tile stands in for it. It is another "
        "landscape, "
        "so the paper's 8 m is no yardstick.");

  const std::string truth_path = voids.cells > 0 ? filled_edition(path) : "";
  const Dem truth = truth_path.empty() ? Dem{} : read_tile(truth_path, run.part(0.1, 0.2)).dem;
  if (!truth_path.empty()) f.notes.push_back("Truth inside the voids: " + truth_path);
  double from = 0.2;
  const double step = 0.8 / 2 / double(std::size(methods));
  for (const auto& [name, file] : methods) {
    const ChosenMethod chosen = find_method(all_fill_methods(), name);
    const auto fill = [&](const Dem& dem) {
      from += step;
      return chosen.method->fill(dem, chosen.settings, run.part(from - step, from)).z;
    };
    const Raster<float> rebuilt = fill(sampled);
    add(f, name + ": RMSE, rebuilt from edges, all cells", kPaperRmse,
        errors_over(tile, rebuilt, tile.known).rmse_m);
    add(f, name + ": RMSE, rebuilt from edges, removed cells", {},
        errors_over(tile, rebuilt, removed_cells(tile, sampled)).rmse_m);
    draw(f, folder.file("rebuilt_" + file + ".png"), rebuilt, tile.spacing, shell.overwrite);
    if (voids.cells > 0) {
      const Raster<float> filled = fill(tile);
      if (!truth_path.empty())
        add(f, name + ": RMSE in the real voids", {},
            errors_over(truth, filled, removed_cells(truth, tile)).rmse_m);
      draw(f, folder.file("voids_" + file + ".png"), filled, tile.spacing, shell.overwrite);
    }
  }
  return f;
}

}  // namespace dem::app
