#pragma once
// Images to files, and the errors of the module as IoError. Private to dem::io.

#include <exception>
#include <string>
#include <vector>

#include "dem/run.h"
#include "io/images/image_module.h"

namespace dem {

/// Hands the module's progress to a Run, and brings what the Run threw back.
class RunProgress {
 public:
  RunProgress(const Run& run, std::string what) : run_(run), what_(std::move(what)) {}

  ImageProgress callback() { return {call, this}; }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  static bool call(void* self, float part);

  const Run& run_;
  std::string what_;
  std::exception_ptr error_;
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

}  // namespace dem
