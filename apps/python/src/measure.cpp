// evaluate, render.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "bind.h"
#include "call.h"
#include "dem/draw.h"
#include "dem/io/places.h"
#include "dem/raytrace.h"
#include "evaluation_json.h"

namespace dem::python {
namespace {

void check_size(const Dem& dem, const char* name, Size size) {
  if (dem.size() != size)
    throw std::invalid_argument(fmt::format("{} has shape ({}, {}); must be ({}, {}), as truth",
                                            name, dem.size().rows, dem.size().cols, size.rows,
                                            size.cols));
}

/// An evaluation as JSON.
std::string evaluate(const DemFile& truth, const DemFile& got, const DemFile* sampled,
                     const std::optional<py::array_t<float>>& sigma, int threads,
                     const py::object& progress) {
  check_size(got.dem, "got", truth.dem.size());
  if (sampled) check_size(sampled->dem, "sampled", truth.dem.size());
  Raster<float> sigma_m;
  if (sigma) sigma_m = dem_from_arrays(*sigma, py::none(), {}).dem.z;
  const Evaluation evaluation = Call(threads, progress)([&](const Run& run) {
    return evaluate_dem(truth.dem, got.dem,
                        {sampled ? &sampled->dem : nullptr, sigma ? &sigma_m : nullptr}, run);
  });
  return app::as_json(evaluation).dump();
}

py::array picture_array(Raster<Rgb>&& picture) {
  auto owner = std::make_unique<Raster<Rgb>>(std::move(picture));
  const py::ssize_t rows = owner->rows(), cols = owner->cols();
  const std::uint8_t* const bytes = owner->cells()[0].data();
  const py::capsule keep(owner.release(), [](void* p) { delete static_cast<Raster<Rgb>*>(p); });
  return py::array_t<std::uint8_t>({rows, cols, py::ssize_t(3)}, bytes, keep);
}

py::array render(const DemFile& file, const std::string& style, const Settings& settings,
                 const std::string& camera, const std::string& target, int threads,
                 const py::object& progress) {
  Call call(threads, progress);
  const Dem& dem = file.dem;
  if (style != "view" && !(camera.empty() && target.empty()))
    throw std::invalid_argument("camera and target are for style \"view\"");
  if (style == "hillshade") {
    HillshadeOptions options;
    apply(settings, fields(options));
    return array_from(call(
        [&](const Run& run) { return hillshade(dem.z, dem.spacing, options, dem.known, run); }));
  }
  if (style == "relief") {
    ReliefOptions options;
    apply(settings, fields(options));
    return picture_array(call([&](const Run& run) {
      return shaded_relief(dem.z, dem.spacing, options, dem.known, run);
    }));
  }
  if (style != "view")
    throw std::invalid_argument("style = " + style + "; must be relief, hillshade or view");
  ViewOptions options;
  apply(settings, fields(options));
  if (!camera.empty()) options.camera = place_in(dem, "camera", camera);
  if (!target.empty()) options.target = place_in(dem, "target", target);
  return picture_array(call([&](const Run& run) { return render_view(dem, options, run); }));
}

}  // namespace

void bind_measure(py::module_& module) {
  using namespace py::literals;
  module.def("evaluate", &evaluate, "truth"_a, "got"_a, "sampled"_a, "sigma"_a, "threads"_a,
             "progress"_a);
  module.def("render", &render, "dem"_a, "style"_a, "settings"_a, "camera"_a, "target"_a,
             "threads"_a, "progress"_a);
}

}  // namespace dem::python
