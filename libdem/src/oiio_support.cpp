#include "oiio_support.h"

#include <algorithm>
#include <vector>

#include "dem/io.h"
#include "staged_file.h"

namespace dem {

bool OiioProgress::call(void* self, float part) {
  auto& progress = *static_cast<OiioProgress*>(self);
  if (progress.error_) return true;
  try {
    progress.run_.report(part, progress.what_);
    return false;
  } catch (...) {
    progress.error_ = std::current_exception();
    return true;
  }
}

std::string one_line(std::string message) {
  std::ranges::replace(message, '\n', ' ');
  return message;
}

namespace {

/// Some of OpenImageIO's writers (PNG) do not notice that the disk is full: only reading tells.
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
  OiioProgress progress(run, "writing");
  const bool written = output->open(staged.path(), spec) &&
                       output->write_image(spec.format, pixels, OIIO::AutoStride, OIIO::AutoStride,
                                           OIIO::AutoStride, OiioProgress::call, &progress);
  const bool closed = output->close();
  progress.rethrow();
  if (!written || !closed) throw IoError(path, one_line(output->geterror()));
  if (!is_whole(staged.path()))
    throw IoError(path, "cannot be written to the end; is the disk full?");
  staged.commit();
}

}  // namespace dem
