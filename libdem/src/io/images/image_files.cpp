#include "io/images/image_files.h"

#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/staged_file.h"

namespace dem::io {
namespace {

/// The module's result, or its message as an IoError, unless the Run threw.
template <class Work>
auto ask_module(const std::string& path, const RunProgress* progress, const Work& work) {
  const ImageModule& module = image_module();
  try {
    return work(module);
  } catch (const std::runtime_error& error) {
    if (progress) progress->rethrow();
    throw IoError(path, error.what());
  }
}

}  // namespace

ImageReader::ImageReader(const std::string& path)
    : path_(path),
      image_(ask_module(path, nullptr, [&](const ImageModule& m) { return m.open(path); })),
      shape_(image_->shape()) {}

std::vector<float> ImageReader::read(const Run& run) {
  std::vector<float> pixels(std::size_t(shape_.cols) * std::size_t(shape_.rows) *
                            std::size_t(shape_.channels));
  RunProgress progress(run, "reading");
  ask_module(path_, &progress,
             [&](const ImageModule&) { image_->read(pixels.data(), progress.callback()); });
  progress.rethrow();
  return pixels;
}

void write_pixels(const std::string& path, const ImageShape& shape, const void* pixels,
                  bool overwrite, const Run& run) {
  StagedFile staged(path, overwrite);
  const GdalErrors quiet;  // GDAL took libtiff's messages for itself
  RunProgress progress(run, "writing");
  // Through memory where the format allows it, so that it is we who write, and see what fails.
  const auto bytes = ask_module(path, &progress, [&](const ImageModule& module) {
    return module.encode(staged.path(), shape, pixels, progress.callback());
  });
  if (!bytes)
    ask_module(path, &progress, [&](const ImageModule& module) {
      module.write(staged.path(), shape, pixels, progress.callback());
    });
  progress.rethrow();
  if (bytes) staged.write({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  staged.commit();
}

std::string encode_pixels(const std::string& name, const ImageShape& shape, const void* pixels) {
  return ask_module(name, nullptr, [&](const ImageModule& module) -> std::string {
    const auto bytes = module.encode(name, shape, pixels, {});
    if (!bytes) throw std::runtime_error("this format can only be written to a file");
    return {bytes->begin(), bytes->end()};
  });
}

}  // namespace dem::io
