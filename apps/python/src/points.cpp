// grid.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "bind.h"
#include "call.h"
#include "dem/io/grid_points.h"
#include "grid_json.h"
#include "settings.h"

namespace dem::python {
namespace {

using app::Json;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

template <class T>
std::vector<T> column(const Doubles& values, const char* name, std::size_t length) {
  check_dimensions(values, name, 1);
  if (std::size_t(values.size()) != length)
    throw std::invalid_argument(
        fmt::format("{} has {} values; must have {}, as z", name, values.size(), length));
  return {values.data(), values.data() + values.size()};
}

Points points_of(const Doubles& x, const Doubles& y, const Doubles& z,
                 const std::optional<Doubles>& sigma, const std::optional<Doubles>& weight) {
  const auto n = std::size_t(z.size());
  Points points;
  points.z = column<float>(z, "z", n);
  points.x = column<double>(x, "x", n);
  points.y = column<double>(y, "y", n);
  if (sigma) points.sigma = column<float>(*sigma, "point_sigma", n);
  if (weight) points.weight = column<float>(*weight, "point_weight", n);
  return points;
}

/// x and y of a line from an array of n rows and 2 columns.
WorldLine line_of(const Doubles& xy, const char* name, std::size_t number) {
  if (xy.ndim() != 2 || xy.shape(1) != 2)
    throw std::invalid_argument(
        fmt::format("{}: line {} must be an array of x and y, of shape (n, 2)", name, number));
  WorldLine line;
  for (py::ssize_t i = 0; i < xy.shape(0); ++i) {
    line.x.push_back(xy.at(i, 0));
    line.y.push_back(xy.at(i, 1));
  }
  return line;
}

std::vector<WorldLine> lines_of(const std::vector<Doubles>& arrays) {
  std::vector<WorldLine> lines;
  for (const Doubles& xy : arrays) lines.push_back(line_of(xy, "breaklines", lines.size()));
  return lines;
}

std::vector<ContourLine> contours_of(const std::vector<std::pair<double, Doubles>>& arrays) {
  std::vector<ContourLine> lines;
  for (const auto& [level_m, xy] : arrays) {
    WorldLine line = line_of(xy, "contours", lines.size());
    lines.push_back({level_m, std::move(line.x), std::move(line.y)});
  }
  return lines;
}

/// `read`: the fields of PointReadOptions; `classes` and `delimiter` are no fields.
void set_reading(GridInput& input, const Settings& read, const std::vector<int>& classes,
                 const std::optional<char>& delimiter) {
  apply(read, fields(input.read));
  input.read.classes = classes;
  input.read.delimiter = delimiter;
}

GridRequest request_of(const DemFile* like, const std::optional<std::array<double, 4>>& bounds,
                       const std::string& cell, bool nodes, const Settings& binning,
                       const Settings& gridding) {
  GridRequest request;
  if (like) request.lattice.like = Lattice{like->dem.ref, like->dem.size(), like->dem.spacing};
  if (bounds) request.lattice.bounds = {(*bounds)[0], (*bounds)[1], (*bounds)[2], (*bounds)[3]};
  if (!cell.empty()) request.lattice.cell = parse_cell_size(cell);
  request.lattice.nodes = nodes;
  request.bin = checked_options<BinOptions>(binning);
  request.gridding = checked_options<GriddingOptions>(gridding);
  return request;
}

Json figures(const std::vector<Figure>& report) {
  Json all = Json::array();
  for (const Figure& f : report)
    all.push_back({{"name", f.name}, {"value", f.value}, {"unit", f.unit}});
  return all;
}

py::tuple grid(const GridInput& input, GridRequest& request, const std::string& method,
               const Settings& settings, bool fill, int threads, const py::object& progress) {
  const std::string name = method.empty() ? default_grid_method(has_contours(input)) : method;
  request.method = choose_method(name, settings);
  request.fill = fill;
  GridResult made =
      Call(threads, progress)([&](const Run& run) { return grid_points(input, request, run); });
  Json report = app::as_json(made.points, made.dem);
  if (!made.points.closed_off.empty()) report["closed_off"] = app::cells_of(made.points.closed_off);
  if (fill) {
    report["method"] = name;
    report["misfit_rms_m"] = made.misfit.rms_m;
    report["misfit_max_m"] = made.misfit.max_m;
    report["report"] = figures(made.report);
  }
  auto file = std::make_unique<DemFile>(DemFile{std::move(made.dem), {}});
  file->source.node_registered = request.lattice.nodes;
  return py::make_tuple(py::cast(std::move(file)), sigma_array(std::move(made.sigma)),
                        report.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

void bind_points(py::module_& module) {
  using namespace py::literals;
  py::class_<GridInput>(module, "GridInput")
      .def(py::init<>())
      .def("read_file", [](GridInput& input, const std::string& path,
                           bool contours) { input.elevations = path, input.contours = contours; })
      .def("take_points",
           [](GridInput& input, const Doubles& x, const Doubles& y, const Doubles& z,
              const std::optional<Doubles>& sigma, const std::optional<Doubles>& weight) {
             input.elevations = points_of(x, y, z, sigma, weight);
           })
      .def("take_contours",
           [](GridInput& input, const std::vector<std::pair<double, Doubles>>& lines) {
             input.elevations = contours_of(lines);
           })
      .def("read_breaklines",
           [](GridInput& input, const std::string& path) { input.breaklines = path; })
      .def("take_breaklines", [](GridInput& input, const std::vector<Doubles>& lines) {
        input.breaklines = lines_of(lines);
      });
  module.def(
      "grid",
      [](GridInput& input, const Settings& read, const std::vector<int>& classes,
         const std::optional<char>& delimiter, const DemFile* like,
         const std::optional<std::array<double, 4>>& bounds, const std::string& cell, bool nodes,
         const Settings& binning, const Settings& gridding, const std::string& method,
         const Settings& settings, bool fill, int threads, const py::object& progress) {
        set_reading(input, read, classes, delimiter);
        GridRequest request = request_of(like, bounds, cell, nodes, binning, gridding);
        return grid(input, request, method, settings, fill, threads, progress);
      },
      "input"_a, "read"_a, "classes"_a, "delimiter"_a, "like"_a, "bounds"_a, "cell"_a, "nodes"_a,
      "binning"_a, "gridding"_a, "method"_a, "settings"_a, "fill"_a, "threads"_a, "progress"_a);
}

}  // namespace dem::python
