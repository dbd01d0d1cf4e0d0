// What a worker of libdem.distributed does: see dem/io/shared_fill.h.

#include <pybind11/stl.h>

#include <algorithm>
#include <unordered_map>

#include "bind.h"
#include "call.h"
#include "common.h"
#include "dem/io/fill_job.h"
#include "dem/io/raster_stream.h"
#include "dem/io/shared_fill.h"
#include "settings.h"

namespace dem::python {
namespace {

using Four = std::array<int, 4>;

Box box_of(const Four& box) { return {box[0], box[1], box[2], box[3]}; }

FillOptions options_of(const std::string& method, const Settings& settings,
                       const HoleChoice& choice, bool whole) {
  return checked({choose_method(method, settings), choice, whole});
}

std::unique_ptr<SharedFill> open(const std::string& path, const std::optional<double>& nodata,
                                 const std::string& method, const Settings& settings,
                                 const HoleChoice& choice, bool whole,
                                 const std::vector<std::string>& aux, const std::string& water,
                                 const std::string& memory) {
  ReadOptions read;
  read.nodata = nodata;
  read.detect_nodata = false;
  return std::make_unique<SharedFill>(path, read, options_of(method, settings, choice, whole),
                                      FillFiles{aux, water, ""}, parse_memory("memory", memory));
}

/// Throws for settings that no raster would do with.
void check_job(const std::string& method, const Settings& settings, const HoleChoice& choice,
               const std::string& memory) {
  options_of(method, settings, choice, false);
  parse_memory("memory", memory);
}

/// Which of many boxes hold a place, by squares.
class BoxIndex {
 public:
  explicit BoxIndex(const std::vector<Four>& boxes) : boxes_(boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for_squares(box_of(boxes[i]), [&](std::uint64_t square) { squares_[square].push_back(i); });
  }

  void add_touched(const Box& box, std::vector<std::size_t>& numbers) const {
    for_squares(box, [&](std::uint64_t square) {
      const auto found = squares_.find(square);
      if (found == squares_.end()) return;
      for (const std::size_t i : found->second) {
        const Box b = box_of(boxes_[i]);
        if (b.col < box.col + box.cols && box.col < b.col + b.cols && b.row < box.row + box.rows &&
            box.row < b.row + b.rows)
          numbers.push_back(i);
      }
    });
  }

 private:
  template <class Each>
  static void for_squares(const Box& box, const Each& each) {
    constexpr int side = 2048;
    for (int y = box.row / side; y <= (box.row + box.rows - 1) / side; ++y)
      for (int x = box.col / side; x <= (box.col + box.cols - 1) / side; ++x)
        each((std::uint64_t(std::uint32_t(y)) << 32) | std::uint32_t(x));
  }

  const std::vector<Four>& boxes_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> squares_;
};

/// Bundles as (bytes, cells of windows, numbers of the tiles that they fill), and the plan in
/// numbers.
py::tuple plan(const SharedFill& raster, const std::vector<std::string>& parts,
               const std::vector<Four>& tiles, std::size_t bundle_cells,
               const py::object& progress) {
  struct Made {
    std::string bytes;
    std::size_t cells = 0;
    std::vector<std::size_t> tiles;
  };
  std::vector<Made> made;
  FillPlan plan;
  Call(0, progress)([&](const Run& run) {
    std::vector<HolePart> all;
    for (const std::string& bytes : parts) all.push_back(part_from_bytes(bytes));
    run.report(0.1, "joining parts");
    plan = raster.plan(all);
    run.report(0.9, "planning");
    const BoxIndex index(tiles);
    for (const FillPlan& bundle : bundles_of(plan, bundle_cells)) {
      Made& m = made.emplace_back(Made{bytes_of(bundle), 0, {}});
      for (const HoleWindow& window : bundle.windows) m.cells += window.box.cells();
      for (const Hole& hole : bundle.holes) index.add_touched(hole.box, m.tiles);
      std::ranges::sort(m.tiles);
      m.tiles.erase(std::unique(m.tiles.begin(), m.tiles.end()), m.tiles.end());
    }
  });
  py::list bundles;
  for (const Made& m : made) bundles.append(py::make_tuple(py::bytes(m.bytes), m.cells, m.tiles));
  const FillReport counts = report_of(plan);
  py::dict report;
  report["unknown"] = counts.unknown;
  report["voids"] = plan.holes.size();
  report["border_voids"] = counts.border_holes;
  report["windows"] = counts.windows;
  report["left_by_choice"] = counts.left_by_choice + counts.left_at_border;
  return py::make_tuple(bundles, report);
}

py::dict fill(SharedFill& raster, const std::string& bytes, const std::string& path,
              const std::string& key, int threads, const py::object& progress) {
  const FillPlan bundle = plan_from_bytes(bytes);
  const FillReport done =
      Call(threads, progress)([&](const Run& run) { return raster.fill(bundle, path, key, run); });
  py::dict out;
  out["filled"] = done.filled;
  out["left"] = done.left;
  out["water"] = done.water_cells;
  out["over_aux"] = done.guide_cells;
  out["windows"] = done.windows;
  out["resumed"] = done.resumed_windows;
  out["seconds"] = done.window_seconds;
  return out;
}

std::size_t write_tile(SharedFill& raster, const std::string& tile, const Four& box,
                       const std::vector<std::string>& journals, const std::string& key,
                       const std::string& out,
                       const std::vector<std::pair<std::string, std::string>>& metadata) {
  WriteOptions options;
  options.overwrite = true;
  if (app::holds_metadata(out, "")) options.metadata = metadata;
  return Call(1, py::none())([&](const Run& run) {
    return raster.write_tile(tile, box_of(box), journals, key, out, options, run);
  });
}

const char* gdal_name(CellType type) {
  constexpr const char* names[] = {"Int8",  "Byte",   "Int16",   "UInt16",
                                   "Int32", "UInt32", "Float32", "Float64"};
  return names[std::size_t(type)];
}

/// What the head of a file says.
py::dict describe(const std::string& path) {
  const RasterReader reader(path, {});
  py::dict out;
  out["size"] = std::pair(reader.size().cols, reader.size().rows);
  out["to_world"] = reader.ref().to_world;
  out["crs"] = reader.ref().crs_wkt;
  out["type"] = gdal_name(reader.source().type);
  out["nodata"] = reader.source().nodata;
  return out;
}

}  // namespace

void bind_mosaic(py::module_& module) {
  using namespace py::literals;
  module.def("describe", &describe, "path"_a);
  module.def("tiles_in", &tiles_in, "folder"_a);
  module.def("check_job", &check_job, "method"_a, "settings"_a, "choice"_a, "memory"_a);
  py::class_<SharedFill>(module, "SharedFill")
      .def(py::init(&open), "path"_a, "nodata"_a, "method"_a, "settings"_a, "choice"_a, "whole"_a,
           "aux"_a, "water"_a, "memory"_a)
      .def_property_readonly(
          "size", [](const SharedFill& r) { return std::pair(r.size().cols, r.size().rows); })
      .def(
          "scan",
          [](SharedFill& raster, const Four& part) {
            return py::bytes(Call(
                1, py::none())([&](const Run&) { return bytes_of(raster.scan(box_of(part))); }));
          },
          "part"_a)
      .def("plan", &plan, "parts"_a, "tiles"_a, "bundle_cells"_a, "progress"_a)
      .def("fill", &fill, "bundle"_a, "path"_a, "key"_a, "threads"_a, "progress"_a)
      .def("write_tile", &write_tile, "tile"_a, "box"_a, "journals"_a, "key"_a, "out"_a,
           "metadata"_a);
}

}  // namespace dem::python
