// Dem: heights with their mask, place and origin; read and write.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "arrays.h"
#include "bind.h"
#include "call.h"
#include "dem/io/geodesy.h"
#include "dem/outliers.h"

namespace dem::python {
namespace {

CellType type_of(const std::string& name) {
  CellType type{};
  Field("dtype", type, cell_type_names(), "").set(name);
  return type;
}

using Six = std::array<double, 6>;

DemFile make(const py::array& z, const py::object& known, const std::optional<double>& nodata,
             const std::optional<std::pair<double, double>>& spacing,
             const std::optional<Six>& to_world, const std::string& crs) {
  DemFile file = dem_from_arrays(z, known, nodata);
  Dem& dem = file.dem;
  if (spacing && to_world)
    throw std::invalid_argument("spacing and to_world both say how large a cell is; give one");
  const auto [dx, dy] = spacing.value_or(std::pair{1., 1.});
  if (!(dx > 0 && dy > 0 && std::isfinite(dx) && std::isfinite(dy)))
    throw std::invalid_argument(
        fmt::format("spacing = ({}, {}); must be two lengths in metres above 0", dx, dy));
  if (spacing && !crs.empty())
    throw std::invalid_argument("crs needs to_world, the place of the cells in it");
  dem.ref = {to_world.value_or(Six{0, dx, 0, 0, 0, -dy}), crs_wkt(crs)};
  set_spacing(dem);
  return file;
}

/// Heights with the original values where float32 is too small for them.
py::array elevation(DemFile& file, const py::handle& owner) {
  const Dem& dem = file.dem;
  if (file.source.exact.empty()) return array_view(file.dem.z, owner);
  Raster<double> values = Raster<double>::unset(dem.size());
  for (std::size_t i = 0; i < values.cells().size(); ++i) {
    const double exact = file.source.exact.cells()[i];
    const float z = dem.z.cells()[i];
    values.cells()[i] = float(exact) == z ? exact : double(z);
  }
  return array_from(std::move(values));
}

py::list evidence(const Source& source) {
  py::list all;
  for (const NodataEvidence& e : source.evidence) {
    py::dict row;
    row["what"] = e.what;
    row["cells"] = e.cells;
    row["used"] = e.used;
    row["why"] = e.why;
    all.append(row);
  }
  return all;
}

std::string outlier_warning(const DemFile& file) {
  if (count(file.dem.known) == 0) return "";
  const Outliers found = find_outliers(file.dem);
  if (found.count == 0) return "";
  const Outlier& first = found.first[0];
  return fmt::format(
      "{} known heights lie outside {:.0f} to {:.0f} m and bend the surface around them, the first "
      "{} at row {}, column {}; if they mean \"unknown\", say so by nodata or known",
      found.count, found.low_m, found.high_m, first.z, first.row, first.col);
}

DemFile read(const std::string& path, int band, const std::optional<double>& nodata,
             bool detect_nodata, const std::string& tile,
             const std::optional<std::pair<double, double>>& height_range, int threads,
             const py::object& progress) {
  ReadOptions options{band, nodata, detect_nodata, tile, {}, {}};
  if (height_range) options.heights = {height_range->first, height_range->second};
  return Call(threads, progress)([&](const Run& run) { return read_dem(path, options, run); });
}

void write(const std::string& path, const DemFile& file, const std::string& format,
           const std::optional<std::string>& dtype, const std::optional<double>& nodata,
           bool compress, bool overwrite,
           const std::vector<std::pair<std::string, std::string>>& metadata, int threads,
           const py::object& progress) {
  WriteOptions options;
  options.format = format;
  if (dtype) options.type = type_of(*dtype);
  options.nodata = nodata;
  options.compress = compress;
  options.overwrite = overwrite;
  options.metadata = metadata;
  Call(threads,
       progress)([&](const Run& run) { write_dem(path, file.dem, file.source, options, run); });
}

}  // namespace

void bind_dem(py::module_& module) {
  using namespace py::literals;
  py::class_<DemFile>(module, "Dem",
                      "Heights in metres, which of them are known, and where they lie. Arrays are\n"
                      "views of it: what is written into them is written into the Dem.")
      .def(py::init(&make), "z"_a, "known"_a = py::none(), "nodata"_a = py::none(),
           "spacing"_a = py::none(), "to_world"_a = py::none(), "crs"_a = "")
      .def_property_readonly(
          "z", [](py::object self) { return array_view(self.cast<DemFile&>().dem.z, self); },
          "float32 heights, 0 where unknown (a view)")
      .def_property_readonly(
          "known",
          [](py::object self) {
            return array_view(self.cast<DemFile&>().dem.known, self).attr("view")("bool");
          },
          "which heights are known (a view)")
      .def_property_readonly(
          "elevation", [](py::object self) { return elevation(self.cast<DemFile&>(), self); },
          "as z (a view); float64 with the original values, where float32 cannot hold them (a "
          "copy)")
      .def_property_readonly(
          "shape", [](const DemFile& f) { return std::pair(f.dem.size().rows, f.dem.size().cols); })
      .def_property_readonly(
          "spacing",
          [](const DemFile& f) { return std::pair(f.dem.spacing.dx_m, f.dem.spacing.dy_m); },
          "size of a cell in metres, east and north; of the middle row, when in degrees")
      .def_property_readonly(
          "to_world", [](const DemFile& f) { return f.dem.ref.to_world; },
          "x = a + b col + c row, y = d + e col + f row of the cells' CENTRES, in CRS units")
      .def_property_readonly(
          "crs", [](const DemFile& f) { return f.dem.ref.crs_wkt; }, "WKT, or \"\"")
      .def_property_readonly(
          "dtype", [](const DemFile& f) { return cell_type_names()[std::size_t(f.source.type)]; },
          "type of the original values; `write` keeps it")
      .def_property_readonly("nodata", [](const DemFile& f) { return f.source.nodata; })
      .def_property_readonly("format", [](const DemFile& f) { return f.source.format; })
      .def_property_readonly("path", [](const DemFile& f) { return f.source.path; })
      .def_property_readonly("node_registered",
                             [](const DemFile& f) { return f.source.node_registered; })
      .def_property_readonly("vertical_datum",
                             [](const DemFile& f) { return f.source.vertical_datum; })
      .def_property_readonly("metadata", [](const DemFile& f) { return f.source.metadata; })
      .def_property_readonly(
          "evidence", [](const DemFile& f) { return evidence(f.source); },
          "what in the file was found to mean \"unknown\", and whether it was taken so")
      .def_property_readonly("_outlier_warning", &outlier_warning)
      .def("__repr__", [](const DemFile& f) {
        const Size size = f.dem.size();
        return fmt::format("<libdem.Dem {} x {} cells of {:.6g} x {:.6g} m, {} unknown>", size.rows,
                           size.cols, f.dem.spacing.dx_m, f.dem.spacing.dy_m,
                           size.cells() - count(f.dem.known));
      });
  module.def("read", &read, "path"_a, "band"_a, "nodata"_a, "detect_nodata"_a, "tile"_a,
             "height_range"_a, "threads"_a, "progress"_a);
  module.def("write", &write, "path"_a, "dem"_a, "format"_a, "dtype"_a, "nodata"_a, "compress"_a,
             "overwrite"_a, "metadata"_a, "threads"_a, "progress"_a);
}

}  // namespace dem::python
