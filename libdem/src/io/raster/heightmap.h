#pragma once
// Heights as the grey levels of an image, through OpenImageIO. Private to dem::io.

#include <string>

#include "dem/io/rasters.h"

namespace dem::io {

/// Whether the name ends in .png, .exr, .jpg or .jpeg (in any case).
bool is_image_name(const std::string& path);

DemFile read_heightmap(const std::string& path, const ReadOptions& options, const Run& run);
void write_heightmap(const std::string& path, const Dem& dem, const Source& source,
                     const WriteOptions& options, const Run& run);

}  // namespace dem::io
