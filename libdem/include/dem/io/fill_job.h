#pragma once
// Filling a raster file: held in memory, or part by part within a bound of memory.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "dem/fill.h"
#include "dem/io/fill_files.h"
#include "dem/io/raster_stream.h"
#include "dem/io/rasters.h"

namespace dem {

/// A layer of a filled raster: its heights, their standard errors in metres, or CellOrigin.
enum class FillLayer { heights, sigma, origin };

/// A box of a filled raster.
struct FilledPart {
  Dem dem;                      ///< voids that were left are unknown
  Raster<std::uint8_t> origin;  ///< CellOrigin of each cell
  Raster<float> sigma{};        ///< empty: not asked for
};

/// "2G", "500M", "750000k" or bytes. Throws std::invalid_argument that names `what`.
std::size_t parse_memory(std::string_view what, const std::string& text);

/// Memory of the machine in bytes.
std::size_t machine_memory();

/// "1.5G", "200M".
std::string text_of_bytes(std::size_t bytes);

/// Fills a raster file, and writes what came of it.
/// Method: fill_holes in memory; with a bound of memory, the raster is scanned row by row, windows
///         go into a journal, a hidden file beside the output, and layers are written row by row.
/// Gives:  the same cells either way.
/// Cost:   memory as bound, and some 200 bytes a void.
class FillJob {
 public:
  struct Options {
    ReadOptions read{};
    FillOptions fill{};
    FillFiles files{};
    std::size_t memory = 0;   ///< bytes; 0: the raster is held in memory as a whole
    std::string out{};        ///< the output: it names the journal
    bool resume = false;      ///< keep the journal when stopped, and go on from one that is there
    int task = 0, tasks = 0;  ///< fill only the windows of task 1 to `tasks` and keep them; 0: all
  };

  /// Opens the raster, and reads it when it is held in memory.
  /// Throws IoError, std::invalid_argument for options that do not fit together, Cancelled.
  FillJob(const std::string& in, Options options, const Run& run = {});
  ~FillJob();
  FillJob(const FillJob&) = delete;
  FillJob& operator=(const FillJob&) = delete;

  Size size() const;
  const GeoRef& ref() const;
  const Source& source() const;
  const FillOptions& options() const { return options_.fill; }  ///< checked() ones

  /// The raster, when it is held in memory; else null.
  const Dem* held() const;

  /// Finds the voids and fills them. Resumed, it takes what tasks have left, too.
  /// Throws IoError, Cancelled; std::invalid_argument when the memory does not do for this raster.
  void fill(const Run& run);

  const FillPlan& plan() const;
  const FillReport& report() const;

  /// A box of what was filled, before finish().
  FilledPart read(const Box& box);

  /// Writes a layer of the whole size. For heights, checks that the known cells written are those
  /// that were read (FillReport::known_kept).
  void write(const std::string& path, FillLayer layer, const Source& source,
             const WriteOptions& options, const Run& run);

  /// Takes the journals away: nothing is left to resume.
  void finish();

 private:
  struct Held;
  struct Streamed;
  std::string in_;
  Options options_;
  std::unique_ptr<Held> held_;  // one of the two
  std::unique_ptr<Streamed> streamed_;
};

}  // namespace dem
