#pragma once
// Filling a raster that need not fit in memory: holes are found strip by strip, filled window by
// window into a journal, and the output is written strip by strip.

#include <memory>
#include <string>

#include "dem/raster_stream.h"
#include "fill/hole_fill.h"
#include "fill/journal.h"

namespace dem::app {

/// "2G", "500M", "750000k" or bytes; throws std::invalid_argument that names the option.
std::size_t parse_memory(std::string_view option, const std::string& text);

/// Memory of the machine in bytes.
std::size_t machine_memory();

class StreamFill {
 public:
  struct Options {
    std::string in, out;  ///< `out` names the journal, a hidden file beside it
    ReadOptions read;
    std::size_t memory = 0;
    bool resume = false;   ///< keep the journal when stopped, and go on from one that is there
    std::string settings;  ///< all that changes a filled cell, to know a journal by
  };

  /// Finds the holes, plans and fills.
  StreamFill(Options options, const FillRequest& request, const Run& run);

  FillOutcome& outcome() { return outcome_; }
  const Source& source() const { return reader_.source(); }
  Size size() const { return reader_.size(); }
  const GeoRef& ref() const { return reader_.ref(); }
  std::size_t resumed_windows() const { return resumed_; }

  enum class Layer { heights, sigma, origin };

  /// Writes a raster of the whole size. For heights, checks that the known cells written are those
  /// that were found (FillOutcome::known_kept).
  void write(const std::string& path, Layer layer, const Source& source,
             const WriteOptions& options, const Run& run);

  /// A box of what was filled, before finish().
  FilledPart read(const Box& box);

  /// Takes the journal away: nothing is left to resume.
  void finish();

 private:
  void scan(const FillRequest& request, const Run& run);
  void fill(const FillRequest& request, const Run& run);
  void overlay(const std::vector<StripPiece>& pieces, Layer layer, const Box& box, Dem& rows) const;

  Options options_;
  RasterReader reader_;
  FillOutcome outcome_;
  FillPlan plan_;
  std::vector<Spacing> spacing_;
  std::string journal_path_;
  std::unique_ptr<Journal> journal_;
  std::size_t resumed_ = 0;
};

}  // namespace dem::app
