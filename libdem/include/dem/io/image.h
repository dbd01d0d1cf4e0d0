#pragma once
// Pictures to files, by OpenImageIO.

#include <string>
#include <string_view>

#include "dem/draw.h"

namespace dem {

/// Writes a picture; the extension says the format (.png, .jpg, .tif ...). Whole or not at all.
/// Throws IoError.
void write_image(const std::string& path, const Raster<std::uint8_t>& grey, bool overwrite = true);
void write_image(const std::string& path, const Raster<Rgb>& picture, bool overwrite = true);

/// The bytes of such a file: `format` is "png" or "jpg". Throws std::invalid_argument.
std::string encode_image(const Raster<std::uint8_t>& grey, std::string_view format);
std::string encode_image(const Raster<Rgb>& picture, std::string_view format);

}  // namespace dem
