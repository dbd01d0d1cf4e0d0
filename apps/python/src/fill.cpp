// fill, supersample.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "bind.h"
#include "call.h"
#include "dem/io/fill_files.h"
#include "dem/io/geodesy.h"
#include "dem/supersample.h"
#include "fill/fill_json.h"
#include "settings.h"

namespace dem::python {
namespace {

using app::Json;

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
}

}  // namespace dem::python
