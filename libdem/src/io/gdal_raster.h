#pragma once
// Raster files through GDAL. Private to dem::io.

#include <string>

#include "dem/io.h"

namespace dem {

DemFile read_gdal(const std::string& path, const ReadOptions& options, const Run& run);

/// `format`: a GDAL driver's short name.
void write_gdal(const std::string& path, const std::string& format, const Dem& dem,
                const Source& source, const WriteOptions& options, const Run& run);

/// The GDAL driver that writes files with this extension, or "".
std::string gdal_format_of(const std::string& path);

}  // namespace dem
