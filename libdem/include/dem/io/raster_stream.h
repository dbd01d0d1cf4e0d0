#pragma once
// Rasters that need not fit in memory: read by boxes, written row by row, through GDAL.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "dem/dem.h"
#include "dem/holes.h"
#include "dem/io/rasters.h"
#include "dem/run.h"

namespace dem {

/// The memory in bytes that GDAL may keep for blocks of all files (it is one cache).
void set_block_cache(std::size_t bytes);

/// One band of elevations, read part by part.
class RasterReader {
 public:
  /// Reads what the file says beside its heights. Accepts what read_dem does; an .hgt or an image
  /// is held in memory. Throws IoError.
  RasterReader(const std::string& path, const ReadOptions& options);
  ~RasterReader();
  RasterReader(const RasterReader&) = delete;
  RasterReader& operator=(const RasterReader&) = delete;

  Size size() const;
  const GeoRef& ref() const;
  const Source& source() const;  ///< until scan(), its nodata is the declared one, without evidence
  std::size_t held_bytes() const;  ///< memory of a file that is not read part by part

  /// Rows in order, each once: `begin` is called first, and again when the rows showed undeclared
  /// no-data and pass once more with it taken as unknown.
  void scan(const std::function<void()>& begin,
            const std::function<void(int row, std::span<const std::uint8_t> known,
                                     std::span<const float> z)>& each,
            const Run& run);

  /// A box, as read_dem gives it; its spacing is left at 1 m. `exact`: the values as doubles, where
  /// float32 cannot hold each of them (else left empty).
  Dem read(const Box& box, Raster<double>* exact = nullptr);

 private:
  struct File;
  std::unique_ptr<File> file_;
  std::unique_ptr<DemFile> whole_;  ///< instead of file_
};

/// Another DEM, brought onto the cells of a raster.
class AlignedReader {
 public:
  /// `target`: the raster's georeference. Throws IoError when the file cannot be read, or only one
  /// of the two says a coordinate system.
  AlignedReader(const std::string& path, const GeoRef& target);
  ~AlignedReader();
  AlignedReader(AlignedReader&&) noexcept;
  AlignedReader& operator=(AlignedReader&&) noexcept;

  /// Its heights at the cells of a box: cubic, reprojected when its coordinates are others. Cells
  /// that it does not cover, or where it is void, are unknown.
  Dem read(const Box& box);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// A raster written row by row; it appears under its name, whole, with commit().
class RasterWriter {
 public:
  /// Formats: GTiff (tiled, compressed), COG, HGT; NAME.vrt: a VRT of GeoTIFFs of 4096 x 4096 cells
  /// in NAME_tiles/; a path that ends in "/": a folder of one-degree .hgt tiles, whose shared
  /// edges are equal, and none for a tile without a known cell.
  /// The no-data value is that of the options, of the source, or a usual one. Throws IoError.
  RasterWriter(const std::string& path, Size size, const GeoRef& ref, const Source& source,
               const WriteOptions& options, const Run& run);
  ~RasterWriter();
  RasterWriter(const RasterWriter&) = delete;
  RasterWriter& operator=(const RasterWriter&) = delete;

  /// The next rows. `exact` (may be empty): used where it rounds to the height, as in write_dem.
  void write(const Dem& rows, const Raster<double>& exact = {});

  /// After the last row. Throws IoError.
  void commit();

  struct File;

 private:
  Size size_;
  int row_ = 0;
  std::unique_ptr<File> file_;
};

}  // namespace dem
