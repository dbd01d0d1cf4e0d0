// sample, generate, erode.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>

#include "arrays.h"
#include "bind.h"
#include "call.h"
#include "dem/erosion.h"
#include "dem/generators.h"
#include "dem/greedy.h"
#include "dem/io/drawing.h"
#include "dem/io/geodesy.h"
#include "dem/io/places.h"
#include "dem/sample.h"
#include "settings.h"

namespace dem::python {
namespace {

std::unique_ptr<DemFile> with_source(Dem&& dem, const Source& source) {
  auto file = std::make_unique<DemFile>(DemFile{std::move(dem), source});
  set_row_spacing(file->dem);
  return file;
}

std::size_t share_of(double share, const char* name, std::size_t known) {
  if (!(share > 0 && share <= 1))
    throw std::invalid_argument(fmt::format("{} = {}; must be in (0, 1]", name, share));
  return std::max<std::size_t>(1, std::size_t(std::llround(share * double(known))));
}

/// One way of sampling: its name and number, as the package's sample() takes them.
Dem sample_by(const Dem& dem, const std::string& way, double value, std::uint64_t seed,
              const ChosenMethod& method, const Run& run) {
  const std::size_t known = count(dem.known);
  const auto whole = [&] {
    if (!(value >= 1 && value <= 1e9 && value == std::floor(value)))
      throw std::invalid_argument(
          fmt::format("{} = {}; must be a whole number above 0", way, value));
    return std::size_t(value);
  };
  const auto above_zero = [&] {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument(fmt::format("{} = {}; must be above 0", way, value));
    return value;
  };
  if (way == "keep") return sample_random(dem, share_of(value, "keep", known), seed);
  if (way == "count") return sample_random(dem, whole(), seed);
  if (way == "every") return sample_regular(dem, int(whole()));
  if (way == "edges") return sample_edges(dem, share_of(value, "edges", known));
  if (way == "voids")
    return sample_voids(dem, {.remove = share_of(value, "voids", known), .seed = seed});
  if (way == "tracks") return sample_tracks(dem, int(whole()), seed);
  if (way == "contours_m") return sample_contours(dem, above_zero());
  if (way == "greedy") return sample_greedy(dem, method, {.count = whole()}, run).dem;
  if (way == "max_error_m")
    return sample_greedy(dem, method, {.max_error_m = above_zero()}, run).dem;
  throw std::logic_error("no way of sampling is called " + way);
}

std::unique_ptr<DemFile> sample(const DemFile& file, const std::string& way, double value,
                                std::uint64_t seed, const std::string& method, int threads,
                                const py::object& progress) {
  if (count(file.dem.known) == 0)
    throw std::invalid_argument("no cell of z is known; nothing can be sampled from it");
  const ChosenMethod chosen = find_method(all_fill_methods(), method);
  Dem sampled = Call(threads, progress)(
      [&](const Run& run) { return sample_by(file.dem, way, value, seed, chosen, run); });
  auto out = with_source(std::move(sampled), file.source);
  if (way == "contours_m") out->source.exact = {};  // levels, not the original heights
  return out;
}

/// The grey levels that a generator starts from, from an array or a file; none for vector files,
/// which are drawn once the canvas is known.
Raster<float> grey_levels(const Generator& generator, const std::optional<py::array>& image,
                          const std::string& file) {
  if (generator.image.empty() && (image || !file.empty()))
    throw std::invalid_argument(fmt::format("{} starts from no image", generator.name));
  if (image) return dem_from_arrays(*image, py::none(), {}).dem.z;
  if (generator.image.empty() || (!file.empty() && is_vector_file(file))) return {};
  if (file.empty())
    throw std::invalid_argument(
        fmt::format("{} needs an image: {}", generator.name, generator.image));
  ReadOptions grey;
  grey.heights = {0, 1};
  return read_dem(file, grey).dem.z;
}

Size size_of(const std::optional<std::pair<int, int>>& shape, const Generator& generator,
             const Raster<float>& grey) {
  const Size size = shape             ? Size{shape->second, shape->first}
                    : !grey.empty()   ? grey.size()
                    : generator.globe ? Size{1440, 720}
                                      : Canvas{}.size;
  if (size.cols < 1 || size.rows < 1)
    throw std::invalid_argument(fmt::format(
        "shape = ({}, {}); must be rows and columns, at least 1", size.rows, size.cols));
  if (!grey.empty() && size != grey.size())
    throw std::invalid_argument(
        fmt::format("shape = ({}, {}); the image has ({}, {}), leave it out", size.rows, size.cols,
                    grey.rows(), grey.cols()));
  return size;
}

std::unique_ptr<DemFile> generate(const std::string& name, const Settings& settings,
                                  const std::optional<std::pair<int, int>>& shape,
                                  const std::pair<double, double>& spacing,
                                  const std::pair<double, double>& origin, const std::string& crs,
                                  const std::optional<py::array>& image, const std::string& file,
                                  int median, int threads, const py::object& progress) {
  ChosenGenerator chosen = find_generator(name);
  const Generator& generator = *chosen.generator;
  chosen.settings.insert(chosen.settings.end(), settings.begin(), settings.end());
  const auto [dx, dy] = spacing;
  if (!(dx > 0 && dy > 0 && std::isfinite(dx) && std::isfinite(dy)))
    throw std::invalid_argument(
        fmt::format("spacing = ({}, {}); must be two lengths in metres above 0", dx, dy));
  Drawing drawing{grey_levels(generator, image, file)};
  const Size size = size_of(shape, generator, drawing.grey);
  const Canvas canvas = generator.globe
                            ? globe_canvas(size)
                            : plane_canvas(size, {dx, dy}, origin.first, origin.second, crs);
  check_canvas(canvas);
  if (!generator.image.empty() && drawing.grey.empty()) drawing = draw_vectors(file, canvas);
  Dem dem = Call(threads, progress)([&](const Run& run) {
    Dem made = generator.generate(canvas, drawing, chosen.settings, run.part(0, 0.9));
    made.z = median_filter(made.z, 5, median, run.part(0.9, 1));
    return made;
  });
  return with_source(std::move(dem), {});
}

py::tuple wear_down(const DemFile& file, const Settings& settings, int threads,
                    const py::object& progress) {
  if (count(file.dem.known) == 0)
    throw std::invalid_argument("no cell of z is known; there is nothing to erode");
  ErosionOptions options;
  apply(settings, fields(options));
  Eroded eroded =
      Call(threads, progress)([&](const Run& run) { return erode(file.dem, options, run); });
  py::dict report;
  report["steps"] = options.steps;
  report["before_m3"] = eroded.before_m3;
  report["after_m3"] = eroded.after_m3;
  report["carried_m3"] = eroded.carried_m3;
  auto out = with_source({std::move(eroded.z), file.dem.known, file.dem.ref, file.dem.spacing},
                         file.source);
  out->source.exact = {};
  out->source.type = CellType::float32;
  return py::make_tuple(py::cast(std::move(out)), array_from(std::move(eroded.water_m)), report);
}

}  // namespace

void bind_terrain(py::module_& module) {
  using namespace py::literals;
  module.def("sample", &sample, "dem"_a, "way"_a, "value"_a, "seed"_a, "method"_a, "threads"_a,
             "progress"_a);
  module.def("generate", &generate, "name"_a, "settings"_a, "shape"_a, "spacing"_a, "origin"_a,
             "crs"_a, "image"_a, "file"_a, "median"_a, "threads"_a, "progress"_a);
  module.def("erode", &wear_down, "dem"_a, "settings"_a, "threads"_a, "progress"_a);
}

}  // namespace dem::python
