#pragma once
// SRTM's .hgt: a square of big-endian int16 heights, sampled at nodes one degree edge to edge.
// Private to dem::io.

#include <cpl_vsi.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dem/holes.h"
#include "dem/io/rasters.h"
#include "io/staged_file.h"

namespace dem::io {

/// Whether the name ends in .hgt, .hgt.gz or .hgt.zip (in any case).
bool is_hgt_name(const std::string& path);

DemFile read_hgt(const std::string& path, const ReadOptions& options, const Run& run);

/// An .hgt that is written from the north to the south.
class HgtWriter {
 public:
  /// Refuses what the format cannot say. Throws IoError.
  HgtWriter(const std::string& path, Size size, const GeoRef& ref, const WriteOptions& options);

  /// The next cells, row after row.
  void write(std::span<const float> z, std::span<const std::uint8_t> known);

  /// After the last cell: all of it is on the disk, though not under its name.
  void close();
  void commit() { staged_.commit(); }

 private:
  struct CloseVsi {
    void operator()(VSILFILE* file) const { VSIFCloseL(file); }
  };

  std::string path_;
  StagedFile staged_;
  std::unique_ptr<VSILFILE, CloseVsi> file_;
};

/// The one-degree tile of each box of a raster, "N36E008.hgt"; neighbours share a row or column.
struct HgtTile {
  std::string name;
  Box box;
};

/// Throws IoError when the raster's cells are not the nodes of whole tiles.
std::vector<HgtTile> hgt_tiles(const std::string& path, Size size, const GeoRef& ref);

}  // namespace dem::io
