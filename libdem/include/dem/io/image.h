#pragma once
// Writes pictures to files, by OpenImageIO.

#include <string>
#include <string_view>

#include "dem/draw.h"

namespace dem {

/// Writes a picture. The extension decides the format (.png, .jpg, .tif and others). The path holds
/// the whole file or is unchanged. Throws IoError.
void write_image(const std::string& path, const Raster<std::uint8_t>& grey, bool overwrite = true);
void write_image(const std::string& path, const Raster<Rgb>& picture, bool overwrite = true);

/// The bytes of such a file. `format` is "png" or "jpg". Throws std::invalid_argument.
std::string encode_image(const Raster<std::uint8_t>& grey, std::string_view format);
std::string encode_image(const Raster<Rgb>& picture, std::string_view format);

}  // namespace dem
