// fill, supersample, grid.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "arrays.h"
#include "bind.h"
#include "call.h"
#include "dem/contours.h"
#include "dem/gridding.h"
#include "dem/io/fill_files.h"
#include "dem/io/geodesy.h"
#include "dem/io/lattices.h"
#include "dem/io/point_files.h"
#include "dem/supersample.h"
#include "fill/fill_json.h"
#include "settings.h"

namespace dem::python {
namespace {

using app::Json;

py::object sigma_array(Raster<float>&& sigma) {
  return sigma.empty() ? py::object(py::none()) : py::object(array_from(std::move(sigma)));
}

void check_known(const Dem& dem) {
  if (count(dem.known) == 0)
    throw std::invalid_argument("no cell of z is known; at least one is needed to fill the others");
}

py::list as_list(const std::vector<Figure>& figures) {
  py::list all;
  for (const Figure& f : figures) {
    py::dict row;
    row["name"] = f.name;
    row["value"] = f.value;
    row["unit"] = f.unit;
    all.append(row);
  }
  return all;
}

/// `temporary`: the Dem is nobody else's, and is filled in place.
py::tuple fill(DemFile& of, bool temporary, const FillOptions& wish, const FillFiles& files,
               const std::string& method, int threads, const py::object& progress) {
  check_known(of.dem);
  const FillOptions options = checked(wish);
  auto file = std::make_unique<DemFile>();
  HoleFill out;
  Json report;
  Call call(threads, progress);
  call([&](const Run& run) {
    *file = temporary ? std::move(of) : of;
    const FillLayers layers = open_layers(files, file->dem.ref);
    out = fill_holes(std::move(file->dem), options, layers, run);
    file->dem = std::move(out.dem);
    report = app::as_json(out.plan, out.report, options.method, method);
    if (options.rim_errors) report["holes"] = app::hole_table(out.plan, out.report, method);
  });
  return py::make_tuple(py::cast(std::move(file)), sigma_array(std::move(out.sigma)),
                        array_from(std::move(out.origin)),
                        report.dump(-1, ' ', false, Json::error_handler_t::replace));
}

DemFile whole_dem(Raster<float>&& z, const Lattice& lattice, bool nodes) {
  DemFile file{{std::move(z), Mask(lattice.size, 1), lattice.ref, lattice.spacing}, {}};
  file.source.node_registered = nodes;
  set_row_spacing(file.dem);
  return file;
}

/// `how`: settings of SupersampleOptions; nodes as the file says, unless they say so.
py::tuple make_finer(const DemFile& coarse, const Settings& how, const std::string& method,
                     const Settings& settings, int threads, const py::object& progress) {
  check_known(coarse.dem);
  const ChosenMethod chosen = choose_method(method, settings);
  SupersampleOptions options;
  options.nodes = coarse.source.node_registered;
  apply(how, fields(options));
  Supersampled fine = Call(threads, progress)(
      [&](const Run& run) { return supersample(coarse.dem, chosen, options, run); });
  py::dict report;
  report["miss_rms_m"] = fine.miss_rms_m;
  report["miss_max_m"] = fine.miss_max_m;
  report["report"] = as_list(fine.filled.report);
  auto file = std::make_unique<DemFile>(
      whole_dem(std::move(fine.filled.z), finer_lattice(coarse.dem, options), options.nodes));
  return py::make_tuple(py::cast(std::move(file)), sigma_array(std::move(fine.filled.sigma)),
                        report);
}

// ---- Points

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

template <class T>
std::vector<T> column(const Doubles& values, const char* name, std::size_t length) {
  check_dimensions(values, name, 1);
  if (std::size_t(values.size()) != length)
    throw std::invalid_argument(
        fmt::format("{} has {} values; must have {}, as z", name, values.size(), length));
  return {values.data(), values.data() + values.size()};
}

/// Points without the ones that have no finite position and elevation.
Points points_of(const Doubles& x, const Doubles& y, const Doubles& z,
                 const std::optional<Doubles>& sigma, const std::optional<Doubles>& weight) {
  const auto n = std::size_t(z.size());
  Points points;
  points.z = column<float>(z, "z", n);
  points.x = column<double>(x, "x", n);
  points.y = column<double>(y, "y", n);
  if (sigma) points.sigma = column<float>(*sigma, "point_sigma", n);
  if (weight) points.weight = column<float>(*weight, "point_weight", n);
  std::vector<bool> good(n);
  for (std::size_t i = 0; i < n; ++i)
    good[i] =
        std::isfinite(points.x[i]) && std::isfinite(points.y[i]) && std::isfinite(points.z[i]);
  const auto keep_good = [&](auto& values) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (good[i]) values[kept++] = values[i];
    values.resize(kept);
  };
  keep_good(points.x), keep_good(points.y), keep_good(points.z);
  keep_good(points.sigma), keep_good(points.weight);
  if (points.size() == 0)
    throw std::invalid_argument("no point has a finite x, y and z; at least one is needed");
  return points;
}

Lattice lattice_of(const Points& points, const std::optional<std::array<double, 4>>& bounds,
                   const std::string& cell, const std::string& crs, bool nodes) {
  Extent extent;
  extent.add(points.x, points.y);
  const std::string wkt = crs_wkt(crs);
  if (cell.empty()) {
    if (bounds) throw std::invalid_argument("bounds needs cell, e.g. cell=\"30m\"");
    return lattice_for(extent, wkt);
  }
  const Bounds b = bounds ? Bounds{(*bounds)[0], (*bounds)[1], (*bounds)[2], (*bounds)[3]}
                          : Bounds{extent.west, extent.south, extent.east, extent.north};
  if (!(b.west < b.east && b.south < b.north))
    throw std::invalid_argument(fmt::format(
        "bounds = ({}, {}, {}, {}); must be west, south, east, north with an area between", b.west,
        b.south, b.east, b.north));
  return lattice_over(b, parse_cell_size(cell), wkt, nodes || !bounds);
}

py::tuple grid(const Doubles& x, const Doubles& y, const Doubles& z,
               const std::optional<Doubles>& sigma, const std::optional<Doubles>& weight,
               const DemFile* like, const std::optional<std::array<double, 4>>& bounds,
               const std::string& cell, const std::string& crs, bool nodes, const Settings& binning,
               const Settings& gridding, const std::string& method, const Settings& settings,
               int threads, const py::object& progress) {
  const ChosenMethod chosen = choose_method(method, settings);
  const Points points = points_of(x, y, z, sigma, weight);
  const auto bin = checked_options<BinOptions>(binning);
  const auto passes = checked_options<GriddingOptions>(gridding);
  if (like && (bounds || !cell.empty() || !crs.empty()))
    throw std::invalid_argument("like says it all: no bounds, cell or crs beside it");
  const Lattice lattice = like ? Lattice{like->dem.ref, like->dem.size(), like->dem.spacing}
                               : lattice_of(points, bounds, cell, crs, nodes);
  BinCounts counts;
  Gridded gridded = Call(threads, progress)([&](const Run& run) {
    Binned binned = bin_points(points, lattice, bin, run.part(0, 0.3));
    counts = binned.counts;
    if (counts.cells == 0)
      throw std::invalid_argument("no point lies on the lattice; are x and y in its system?");
    if (!bin.plane) binned.off_centre.clear();
    return fill_points(binned, chosen, passes, run.part(0.3, 1));
  });
  py::dict report;
  report["points"] = counts.points;
  report["outside"] = counts.outside;
  report["combined"] = counts.combined;
  report["duplicates"] = counts.duplicates;
  report["outlier_cells"] = counts.outliers;
  report["known_cells"] = counts.cells;
  report["misfit_rms_m"] = gridded.misfit.rms_m;
  report["misfit_max_m"] = gridded.misfit.max_m;
  report["report"] = as_list(gridded.filled.report);
  auto file = std::make_unique<DemFile>(whole_dem(std::move(gridded.filled.z), lattice, nodes));
  return py::make_tuple(py::cast(std::move(file)), sigma_array(std::move(gridded.filled.sigma)),
                        report);
}

}  // namespace

void bind_fill(py::module_& module) {
  using namespace py::literals;
  py::class_<HoleChoice>(module, "HoleChoice")
      .def(py::init([](bool inner_only, const std::optional<double>& max_area_km2,
                       const std::optional<double>& max_distance_m,
                       const std::optional<std::size_t>& min_cells, const std::string& where) {
             return HoleChoice{inner_only, max_area_km2, max_distance_m, min_cells, where};
           }),
           "inner_only"_a, "max_area_km2"_a, "max_distance_m"_a, "min_cells"_a, "where"_a);
  module.def("hole_facts", [] {
    std::vector<std::pair<std::string, std::string>> facts;
    for (const HoleFact& fact : hole_facts()) facts.emplace_back(fact.name, fact.doc);
    return facts;
  });
  py::list origins;
  for (const auto& [name, origin] : {std::pair{"measured", CellOrigin::measured},
                                     {"method", CellOrigin::method},
                                     {"guide", CellOrigin::guide},
                                     {"water", CellOrigin::water},
                                     {"left", CellOrigin::left}})
    origins.append(py::make_tuple(name, int(origin)));
  module.attr("cell_origins") = origins;
  module.def(
      "fill",
      [](DemFile& dem, bool temporary, const std::string& method, const Settings& settings,
         const HoleChoice& choice, bool whole, const std::vector<std::string>& aux,
         const std::string& water, const std::string& region, bool hole_table, int threads,
         const py::object& progress) {
        const FillOptions options{choose_method(method, settings), choice, whole, false,
                                  hole_table};
        return fill(dem, temporary, options, {aux, water, region}, method, threads, progress);
      },
      "dem"_a, "temporary"_a, "method"_a, "settings"_a, "choice"_a, "whole"_a, "aux"_a, "water"_a,
      "region"_a, "hole_table"_a, "threads"_a, "progress"_a);
  module.def("supersample", &make_finer, "dem"_a, "how"_a, "method"_a, "settings"_a, "threads"_a,
             "progress"_a);
  module.def("grid", &grid, "x"_a, "y"_a, "z"_a, "sigma"_a, "weight"_a, "like"_a, "bounds"_a,
             "cell"_a, "crs"_a, "nodes"_a, "binning"_a, "gridding"_a, "method"_a, "settings"_a,
             "threads"_a, "progress"_a);
}

}  // namespace dem::python
