#pragma once
// Filling a raster that need not fit in memory: holes are found strip by strip, filled window by
// window into a journal, and the output is written strip by strip.

#include <memory>
#include <string>

#include "dem/io/raster_stream.h"
#include "fill/hole_fill.h"
#include "fill/journal.h"

namespace dem::app {

/// "2G", "500M", "750000k" or bytes; throws std::invalid_argument that names the option.
std::size_t parse_memory(std::string_view option, const std::string& text);

/// Memory of the machine in bytes.
std::size_t machine_memory();

/// Code, libraries, small things; and what GDAL may keep of all files.
constexpr std::size_t program_bytes = std::size_t{96} << 20;
std::size_t block_cache(std::size_t memory);

/// Bytes that a method takes for each cell of a window, its input and result included.
std::size_t bytes_a_cell(const FillRequest& request);

/// "1.5G", "200M".
std::string text_of_bytes(std::size_t bytes);

class StreamFill {
 public:
  struct Options {
    std::string in, out;  ///< `out` names the journal, a hidden file beside it
    ReadOptions read;
    std::size_t memory = 0;
    int task = 0, tasks = 0;  ///< fill only the windows of task 1 to `tasks`, and keep them; 0: all
    bool resume = false;      ///< keep the journal when stopped, and go on from one that is there
    std::string settings;     ///< all that changes a filled cell, to know a journal by
  };

  /// Finds the holes, plans and fills. Resumed, it takes what tasks have left, too.
  StreamFill(Options options, const FillRequest& request, const Run& run);

  FillOutcome& outcome() { return outcome_; }
  const Source& source() const { return reader_.source(); }
  Size size() const { return reader_.size(); }
  const GeoRef& ref() const { return reader_.ref(); }
  std::size_t resumed_windows() const { return resumed_; }

  using Layer = app::Layer;

  /// Writes a raster of the whole size. For heights, checks that the known cells written are those
  /// that were found (FillOutcome::known_kept).
  void write(const std::string& path, Layer layer, const Source& source,
             const WriteOptions& options, const Run& run);

  /// A box of what was filled, before finish().
  FilledPart read(const Box& box);

  /// Takes the journals away: nothing is left to resume.
  void finish();

 private:
  void scan(const FillRequest& request, const Run& run);
  void fill(const FillRequest& request, const Run& run);
  void open_journals();
  bool is_done(std::size_t window) const;

  Options options_;
  RasterReader reader_;
  FillOutcome outcome_;
  FillPlan plan_;
  std::vector<Spacing> spacing_;
  std::vector<std::string> journal_paths_;
  std::vector<std::unique_ptr<Journal>> journals_;  // its own, and those of tasks
  std::size_t resumed_ = 0;
};

}  // namespace dem::app
