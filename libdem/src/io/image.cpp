#include "dem/image.h"

#include "dem/io.h"
#include "oiio_support.h"

namespace dem {
namespace {

// A third of the bytes of the library's own 98, and no difference to the eye.
constexpr int kJpegQuality = 85;

void write_bytes(const std::string& path, Size size, int channels, const void* bytes,
                 bool overwrite) {
  if (size.cells() == 0) throw IoError(path, "a picture of no pixels cannot be written");
  OIIO::ImageSpec spec(size.cols, size.rows, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("CompressionQuality", kJpegQuality);
  write_pixels(path, spec, bytes, overwrite, {});
}

}  // namespace

void write_image(const std::string& path, const Raster<std::uint8_t>& grey, bool overwrite) {
  write_bytes(path, grey.size(), 1, grey.cells().data(), overwrite);
}

void write_image(const std::string& path, const Raster<Rgb>& picture, bool overwrite) {
  static_assert(sizeof(Rgb) == 3);
  write_bytes(path, picture.size(), 3, picture.cells().data(), overwrite);
}

}  // namespace dem
