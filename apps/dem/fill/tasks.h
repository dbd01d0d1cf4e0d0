#pragma once
// Filling a raster by many: windows are dealt out to tasks, tasks leave what they filled in
// journals, and whoever writes a part of the output looks into these.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "dem/hole_parts.h"
#include "dem/io/raster_stream.h"
#include "fill/hole_fill.h"
#include "fill/journal.h"

namespace dem::app {

/// Windows [first, second) of task `task` (from 0) of `tasks`: neighbours, with about as many cells
/// as every other task's.
std::pair<std::size_t, std::size_t> windows_of_task(const std::vector<HoleWindow>& windows,
                                                    std::size_t task, std::size_t tasks);

/// Some windows of a raster with their holes: all that a worker needs to know of the plan.
struct Bundle {
  std::vector<Hole> holes;
  std::vector<HoleWindow> windows;  ///< their holes are numbers in `holes`
  bool whole = false;               ///< the raster is one problem, see FillPlan

  std::string bytes() const;
  static Bundle from_bytes(std::string_view bytes);
};

/// Deals the windows of a plan out, so many cells to a bundle at least.
std::vector<Bundle> make_bundles(const FillPlan& plan, const std::vector<Hole>& holes,
                                 std::size_t cells);

/// A HolePart as bytes for another process on a machine of this kind, and back.
std::string bytes_of(const HolePart& part);
HolePart part_from_bytes(std::string_view bytes);

/// What a bundle's journal says was done.
struct BundleOutcome {
  std::size_t filled = 0, left = 0, water = 0, over_aux = 0, windows = 0, resumed = 0;
  double seconds = 0;
};

/// A raster that many processes fill, each with an object of its own.
class SharedRaster {
 public:
  /// The raster must declare its no-data value (or `read` says it): nobody sees it as a whole.
  /// Throws IoError, std::invalid_argument.
  SharedRaster(const std::string& path, const ReadOptions& read, FillRequest request,
               std::size_t memory);

  Size size() const { return reader_.size(); }
  const GeoRef& ref() const { return reader_.ref(); }

  /// Step 1, of every part: see scan_part.
  HolePart scan(const Box& part);

  /// Step 2, once, from all parts. Throws std::invalid_argument when a window needs more memory.
  FillPlan plan(const std::vector<HolePart>& parts, std::vector<Hole>& holes,
                FillOutcome& outcome) const;

  /// Step 3, of every bundle: fills it into a journal at `path`, or goes on with one that is there.
  /// The journal stands under its name when it is whole.
  BundleOutcome fill(const Bundle& bundle, const std::string& path, const std::string& key,
                     const Run& run);

  /// Step 4, of every tile: writes the box of the filled raster, as a file like `tile`. The
  /// journals are those that have cells in it. Returns how many cells are still unknown.
  std::size_t write_tile(const std::string& tile, const Box& box,
                         const std::vector<std::string>& journals, const std::string& key,
                         const std::string& out, const WriteOptions& options, const Run& run);

 private:
  void check_memory(std::size_t bytes, const std::string& what) const;

  RasterReader reader_;
  FillRequest request_;
  std::size_t memory_;
  std::vector<Spacing> spacing_;
};

}  // namespace dem::app
