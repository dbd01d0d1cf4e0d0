#pragma once
// Pictures to files, by OpenImageIO.

#include <string>

#include "dem/draw.h"

namespace dem {

/// Writes a picture; the extension says the format (.png, .jpg, .tif ...). Whole or not at all.
/// Throws IoError.
void write_image(const std::string& path, const Raster<std::uint8_t>& grey, bool overwrite = true);
void write_image(const std::string& path, const Raster<Rgb>& picture, bool overwrite = true);

}  // namespace dem
