#pragma once
// A raster that many processes fill: each looks at parts, fills bundles of windows into journals,
// and writes tiles from these. Any scheduler can hand out the steps.

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dem/fill.h"
#include "dem/hole_parts.h"
#include "dem/io/fill_files.h"
#include "dem/io/raster_stream.h"

namespace dem {

/// The share of one of `tasks` tasks (from 0): neighbouring windows, with about as many cells as
/// every other task's.
WindowRange windows_of_task(const std::vector<HoleWindow>& windows, std::size_t task,
                            std::size_t tasks);

/// A plan cut into plans of some windows with their holes alone, of at least `cells` cells each:
/// all that a worker needs to know.
std::vector<FillPlan> bundles_of(const FillPlan& plan, std::size_t cells);

/// A HolePart or a plan as bytes for another process on a machine of this kind, and back.
/// Throws std::runtime_error when bytes are missing.
std::string bytes_of(const HolePart& part);
HolePart part_from_bytes(std::string_view bytes);
std::string bytes_of(const FillPlan& plan);
FillPlan plan_from_bytes(std::string_view bytes);

/// Each process has an object of its own. The raster must declare its nodata value (or `read` gives
/// it): nobody sees it as a whole.
class SharedFill {
 public:
  /// `memory`: bytes for each process. Throws IoError, std::invalid_argument.
  SharedFill(const std::string& path, const ReadOptions& read, const FillOptions& options,
             FillFiles files, std::size_t memory);

  Size size() const { return reader_.size(); }
  const GeoRef& ref() const { return reader_.ref(); }

  /// Step 1, of every part: see scan_part.
  HolePart scan(const Box& part);

  /// Step 2, once, from all parts. Throws std::invalid_argument when a window needs more memory.
  FillPlan plan(const std::vector<HolePart>& parts) const;

  /// Step 3, of every bundle: fills it into a journal at `path`, or goes on with one that is there.
  /// The journal stands under its name when it is whole.
  FillReport fill(const FillPlan& bundle, const std::string& path, const std::string& key,
                  const Run& run);

  /// Step 4, of every tile: writes the box of the filled raster, as a file like `tile`. The
  /// journals are those that have cells in it. Returns the number of cells that are still unknown.
  std::size_t write_tile(const std::string& tile, const Box& box,
                         const std::vector<std::string>& journals, const std::string& key,
                         const std::string& out, const WriteOptions& options, const Run& run);

 private:
  void check_memory(std::size_t bytes, const std::string& what) const;

  RasterReader reader_;
  FillOptions options_;
  FillFiles files_;
  std::size_t memory_;
  std::vector<Spacing> spacing_;
};

}  // namespace dem
