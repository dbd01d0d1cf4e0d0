#pragma once
// Rasters that may be larger than memory. They are read by boxes and written row by row, through
// GDAL.

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

/// The memory in bytes that GDAL may use for blocks of all files together.
void set_block_cache(std::size_t bytes);

/// One band of elevations, read part by part.
class RasterReader {
 public:
  /// Reads what the file says in addition to its heights. It accepts what read_dem accepts. An .hgt
  /// file or an image is kept in memory. Throws IoError.
  RasterReader(const std::string& path, const ReadOptions& options);
  ~RasterReader();
  RasterReader(const RasterReader&) = delete;
  RasterReader& operator=(const RasterReader&) = delete;

  Size size() const;
  const GeoRef& ref() const;
  const Source& source() const;  ///< until scan(), its nodata is the declared one, without evidence
  std::size_t held_bytes() const;  ///< memory of a file that is not read part by part

  /// Delivers the rows in order, each once. `begin` is called first. It is called again when the
  /// rows contain undeclared nodata; the rows then pass once more, with that value treated as
  /// unknown.
  void scan(const std::function<void()>& begin,
            const std::function<void(int row, std::span<const std::uint8_t> known,
                                     std::span<const float> z)>& each,
            const Run& run);

  /// A box, as read_dem gives it. Its spacing is 1 m. `exact` receives the values as doubles where
  /// float32 cannot hold each of them, and is empty otherwise.
  Dem read(const Box& box, Raster<double>* exact = nullptr);

 private:
  struct File;
  std::unique_ptr<File> file_;
  std::unique_ptr<DemFile> whole_;  ///< instead of file_
};

/// Another DEM, resampled to the cells of a raster.
class AlignedReader {
 public:
  /// `target` is the georeference of the raster. Throws IoError when the file cannot be read, or
  /// when only one of the two has a coordinate system.
  AlignedReader(const std::string& path, const GeoRef& target);
  ~AlignedReader();
  AlignedReader(AlignedReader&&) noexcept;
  AlignedReader& operator=(AlignedReader&&) noexcept;

  /// Its heights at the cells of a box, by cubic resampling, reprojected if its coordinate system
  /// is a different one. Cells that it does not cover, or where it is void, are unknown.
  Dem read(const Box& box);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// A raster that is written row by row. The complete file appears under its name with commit().
class RasterWriter {
 public:
  /// Formats: GTiff (tiled, compressed), COG, HGT. NAME.vrt: a VRT of GeoTIFFs of 4096 x 4096 cells
  /// in NAME_tiles/. A path that ends in "/": a folder of one-degree .hgt tiles with equal shared
  /// edges; a tile without a known cell is not written.
  /// The nodata value is that of the options, that of the source, or a common one. Throws IoError.
  RasterWriter(const std::string& path, Size size, const GeoRef& ref, const Source& source,
               const WriteOptions& options, const Run& run);
  ~RasterWriter();
  RasterWriter(const RasterWriter&) = delete;
  RasterWriter& operator=(const RasterWriter&) = delete;

  /// Writes the next rows. `exact` (may be empty) is used where it rounds to the height, as in
  /// write_dem.
  void write(const Dem& rows, const Raster<double>& exact = {});

  /// Call it after the last row. Throws IoError.
  void commit();

  struct File;

 private:
  Size size_;
  int row_ = 0;
  std::unique_ptr<File> file_;
};

}  // namespace dem
