#pragma once
// Raster files through GDAL. Private to dem::io.

#include <cpl_string.h>
#include <gdal.h>

#include <optional>
#include <string>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"

namespace dem::io {

DemFile read_gdal(const std::string& path, const ReadOptions& options, const Run& run);

/// `format`: a GDAL driver's short name.
void write_gdal(const std::string& path, const std::string& format, const Dem& dem,
                const Source& source, const WriteOptions& options, const Run& run);

// What reading and writing whole and part by part have in common.

/// A raster file, open, and the band of elevations in it.
struct OpenBand {
  DatasetPtr dataset;
  GDALRasterBandH band = nullptr;
  GDALRasterBandH mask = nullptr;  ///< of its own; null: none
  Source source;
  GeoRef ref;
  Size size;
  double scale = 1, offset = 0;  ///< metres = file value * scale + offset
  std::optional<double> declared_nodata;
  bool signed_byte = false;     ///< GDAL gives 0..255 for -128..127
  bool floats_hold_it = false;  ///< every value of the type is a float32
  bool in_other_units() const { return scale != 1 || offset != 0; }
};
OpenBand open_band(const std::string& path, const ReadOptions& options, GdalErrors& errors);

GDALDataType gdal_type(CellType type);

/// Place and coordinate system of a dataset.
void set_georeference(GDALDatasetH dataset, const GeoRef& ref);

/// What goes with the cells of a dataset of one band, all of it before the first cell.
void describe_dataset(GDALDatasetH dataset, const GeoRef& ref, CellType type,
                      std::optional<double> nodata, const Source& source,
                      const WriteOptions& options);

CPLStringList creation_options(const std::string& format, CellType type,
                               const WriteOptions& options, const Run& run);

/// Throws IoError when the driver has not one of the creation options, or not its value.
void check_creation_options(const std::string& path, const std::string& format,
                            const WriteOptions& options);

/// Throws IoError when there is no such driver or it cannot write.
GDALDriverH checked_driver(const std::string& path, const std::string& format);

/// The GDAL driver that writes files with this extension, or "".
std::string gdal_format_of(const std::string& path);

}  // namespace dem::io
