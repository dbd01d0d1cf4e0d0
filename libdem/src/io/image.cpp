#include "dem/io/image.h"

#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/images/image_files.h"

namespace dem {
using namespace io;
namespace {

// A third of the bytes of the library's own 98, and no difference to the eye.
constexpr int kJpegQuality = 85;

ImageShape shape_of(Size size, int channels) {
  return {.cols = size.cols, .rows = size.rows, .channels = channels, .quality = kJpegQuality};
}

void write_bytes(const std::string& path, Size size, int channels, const void* bytes,
                 bool overwrite) {
  if (size.cells() == 0) throw IoError(path, "a picture of no pixels cannot be written");
  write_pixels(path, shape_of(size, channels), bytes, overwrite, {});
}

std::string encode_bytes(Size size, int channels, const void* bytes, std::string_view format) {
  if (size.cells() == 0) throw std::invalid_argument("a picture must have pixels");
  if (format != "png" && format != "jpg")
    throw std::invalid_argument("format = " + std::string(format) + "; must be png or jpg");
  return encode_pixels("picture." + std::string(format), shape_of(size, channels), bytes);
}

}  // namespace

void write_image(const std::string& path, const Raster<std::uint8_t>& grey, bool overwrite) {
  write_bytes(path, grey.size(), 1, grey.cells().data(), overwrite);
}

void write_image(const std::string& path, const Raster<Rgb>& picture, bool overwrite) {
  static_assert(sizeof(Rgb) == 3);
  write_bytes(path, picture.size(), 3, picture.cells().data(), overwrite);
}

std::string encode_image(const Raster<std::uint8_t>& grey, std::string_view format) {
  return encode_bytes(grey.size(), 1, grey.cells().data(), format);
}

std::string encode_image(const Raster<Rgb>& picture, std::string_view format) {
  return encode_bytes(picture.size(), 3, picture.cells().data(), format);
}

}  // namespace dem
