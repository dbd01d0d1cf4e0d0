#include "dem/io/image.h"

#include <OpenImageIO/filesystem.h>

#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/oiio_support.h"

namespace dem {
using namespace io;
namespace {

// A third of the bytes of the library's own 98, and no difference to the eye.
constexpr int kJpegQuality = 85;

OIIO::ImageSpec spec_of(Size size, int channels) {
  OIIO::ImageSpec spec(size.cols, size.rows, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("CompressionQuality", kJpegQuality);
  return spec;
}

void write_bytes(const std::string& path, Size size, int channels, const void* bytes,
                 bool overwrite) {
  if (size.cells() == 0) throw IoError(path, "a picture of no pixels cannot be written");
  write_pixels(path, spec_of(size, channels), bytes, overwrite, {});
}

std::string encode_bytes(Size size, int channels, const void* bytes, std::string_view format) {
  if (size.cells() == 0) throw std::invalid_argument("a picture must have pixels");
  if (format != "png" && format != "jpg")
    throw std::invalid_argument("format = " + std::string(format) + "; must be png or jpg");
  const std::string name = "picture." + std::string(format);
  const auto output = OIIO::ImageOutput::create(name);
  OIIO::Filesystem::IOVecOutput memory;
  if (!output || !output->set_ioproxy(&memory) || !output->open(name, spec_of(size, channels)) ||
      !output->write_image(OIIO::TypeDesc::UINT8, bytes) || !output->close())
    throw IoError(name, one_line(output ? output->geterror() : OIIO::geterror()));
  return {memory.buffer().begin(), memory.buffer().end()};
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
