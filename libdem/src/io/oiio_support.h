#pragma once
// OpenImageIO's progress, messages and writing as this library has them. Private to dem::io.

#include <OpenImageIO/imageio.h>

#include <string>

#include "dem/run.h"
#include "io/kept_progress.h"

namespace dem::io {

/// Hands OpenImageIO's progress to a Run and brings its exceptions back.
class OiioProgress : public KeptProgress {
 public:
  using KeptProgress::KeptProgress;
  /// Gives true to stop, as OpenImageIO wants it.
  static bool call(void* self, float part) {
    return !static_cast<OiioProgress*>(self)->report(part);
  }
};

/// An OpenImageIO message on one line.
std::string one_line(std::string message);

/// Writes an image whole or not at all; `pixels` are of the type spec.format.
/// Throws IoError, Cancelled.
void write_pixels(const std::string& path, const OIIO::ImageSpec& spec, const void* pixels,
                  bool overwrite, const Run& run);

}  // namespace dem::io
