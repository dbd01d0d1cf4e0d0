#include "io/oiio_support.h"

#include <OpenImageIO/filesystem.h>

#include <algorithm>
#include <vector>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/staged_file.h"

namespace dem::io {

std::string one_line(std::string message) {
  std::ranges::replace(message, '\n', ' ');
  return message;
}

namespace {

/// Whether an image can be read to its end: not every writer notices that the disk is full.
bool is_whole(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) return false;
  const OIIO::ImageSpec& spec = input->spec();
  std::vector<char> bytes(spec.image_bytes(true));
  return input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeUnknown, bytes.data());
}

}  // namespace

void write_pixels(const std::string& path, const OIIO::ImageSpec& spec, const void* pixels,
                  bool overwrite, const Run& run) {
  StagedFile staged(path, overwrite);
  const auto output = OIIO::ImageOutput::create(staged.path());
  if (!output) throw IoError(path, one_line(OIIO::geterror()));
  if (spec.alpha_channel >= 0 && !output->supports("alpha"))
    throw IoError(path, "this format has no alpha for unknown cells; give --unknown-grey");

  // Through memory where the format allows it, so that it is we who write, and see what fails.
  OIIO::Filesystem::IOVecOutput memory;
  const bool buffered = output->supports("ioproxy") && output->set_ioproxy(&memory);
  const GdalErrors quiet;  // GDAL took libtiff's messages for itself
  OiioProgress progress(run, "writing");
  const bool written = output->open(staged.path(), spec) &&
                       output->write_image(spec.format, pixels, OIIO::AutoStride, OIIO::AutoStride,
                                           OIIO::AutoStride, OiioProgress::call, &progress);
  const bool closed = output->close();
  progress.rethrow();
  if (!written || !closed) throw IoError(path, one_line(output->geterror()));
  if (buffered)
    staged.write({reinterpret_cast<const char*>(memory.buffer().data()), memory.buffer().size()});
  else if (!is_whole(staged.path()))
    throw IoError(path, "cannot be written to the end; is the disk full?");
  staged.commit();
}

}  // namespace dem::io
