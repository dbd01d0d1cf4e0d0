#pragma once
// Images to files, and the errors of the module as IoError. Private to dem::io.

#include <string>
#include <vector>

#include "dem/run.h"
#include "io/images/image_module.h"
#include "io/kept_progress.h"

namespace dem::io {

/// Hands the module's progress to a Run.
class RunProgress : public KeptProgress {
 public:
  using KeptProgress::KeptProgress;
  ImageProgress callback() { return {call, this}; }

 private:
  static bool call(void* self, float part) {
    return !static_cast<RunProgress*>(self)->report(double(part));
  }
};

/// An image and all its pixels can be had from it.
class ImageReader {
 public:
  /// Throws IoError.
  explicit ImageReader(const std::string& path);

  const ImageShape& shape() const { return shape_; }
  /// Throws IoError, Cancelled.
  std::vector<float> read(const Run& run);

 private:
  std::string path_;
  std::unique_ptr<OpenImage> image_;
  ImageShape shape_;
};

/// Writes an image whole or not at all; `pixels` are of the type shape.type.
/// Throws IoError, Cancelled.
void write_pixels(const std::string& path, const ImageShape& shape, const void* pixels,
                  bool overwrite, const Run& run);

/// The bytes of such a file. Throws IoError.
std::string encode_pixels(const std::string& name, const ImageShape& shape, const void* pixels);

}  // namespace dem::io
