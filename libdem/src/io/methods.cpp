#include "dem/io/methods.h"

#include <fmt/format.h>
#include <gdal_alg.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/gdal_support.h"
#include "io/images/image_module.h"

namespace dem {
using namespace io;
namespace {

/// The result of another library, with known cells bit for bit again whatever it did to them.
/// Every cell must be a number.
Filled finish(const Dem& dem, Raster<float> z) {
  const auto known = dem.known.cells();
  const auto from = dem.z.cells();
  const auto to = z.cells();
  std::size_t left = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (known[i]) to[i] = from[i];
    left += !std::isfinite(to[i]);
  }
  if (left) throw std::runtime_error(fmt::format("{} cells were left unfilled", left));
  Filled filled;
  filled.z = std::move(z);
  return filled;
}

// --- GDAL ------------------------------------------------------------------------------------

struct IdwOptions {
  int smoothing_passes = 0;
};

std::vector<Field> fields(IdwOptions& o) {
  return {{"smoothing_passes",
           o.smoothing_passes,
           {0, 1000},
           "",
           "3 x 3 mean filter over the filled cells, so many times"}};
}

Filled fill_idw(const Dem& dem, const IdwOptions& options, const Run& run) {
  check_fillable(dem);
  check_options(options);

  Raster<float> z = dem.z;
  Mask known = dem.known;
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    if (!known.cells()[i]) z.cells()[i] = std::numeric_limits<float>::quiet_NaN();
  const auto [cols, rows] = dem.size();
  const DatasetPtr heights = wrap_cells(z.cells().data(), cols, rows, GDT_Float32);
  const DatasetPtr mask = wrap_cells(known.cells().data(), cols, rows, GDT_Byte);

  const GdalErrors errors;
  GdalProgress progress(run, "idw");
  char in_memory[] = "TEMP_FILE_DRIVER=MEM";
  char* list[] = {in_memory, nullptr};
  const CPLErr error =
      GDALFillNodata(GDALGetRasterBand(heights.get(), 1), GDALGetRasterBand(mask.get(), 1),
                     std::ceil(std::hypot(cols, rows)), 0, options.smoothing_passes, list,
                     GdalProgress::call, &progress);
  progress.rethrow();
  if (error != CE_None) throw std::runtime_error("GDALFillNodata: " + errors.first());
  return finish(dem, std::move(z));
}

// --- OpenImageIO -------------------------------------------------------------------------------

struct PushPullOptions {};

std::vector<Field> fields(PushPullOptions&) { return {}; }

Filled fill_pushpull(const Dem& dem, const PushPullOptions&, const Run& run) {
  check_fillable(dem);
  run.report(0, "pushpull");

  // Two channels, height and alpha; alpha 0 (and height 0, as colours come multiplied) is a hole.
  const auto [cols, rows] = dem.size();
  std::vector<float> pixels(2 * dem.size().cells());
  for (std::size_t i = 0; i < dem.size().cells(); ++i)
    if (dem.known.cells()[i]) {
      pixels[2 * i] = dem.z.cells()[i];
      pixels[2 * i + 1] = 1;
    }
  Raster<float> z(dem.size());
  image_module().fill_holes_pushpull(pixels.data(), z.cells().data(), cols, rows, run.threads);
  run.report(1, "pushpull");
  return finish(dem, std::move(z));
}

}  // namespace

const std::vector<FillMethod>& baseline_methods() {
  static const std::vector<FillMethod> table{
      make_method<IdwOptions>("idw", "inverse distance by GDAL's FillNodata, no distance limit", "",
                              {.bytes_per_cell = 64}, {}, fill_idw),
      make_method<PushPullOptions>("pushpull", "push-pull pyramid by OpenImageIO", "gortler1996",
                                   {.bytes_per_cell = 64}, {}, fill_pushpull)};
  return table;
}

const std::vector<FillMethod>& all_fill_methods() {
  static const std::vector<FillMethod> table = [] {
    std::vector<FillMethod> all = fill_methods();
    const auto& others = baseline_methods();
    all.insert(all.end(), others.begin(), others.end());
    return all;
  }();
  return table;
}

}  // namespace dem
