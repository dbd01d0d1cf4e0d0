#pragma once
// OpenImageIO's progress as this library has it. Private to dem::io.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <exception>
#include <string>

#include "dem/run.h"

namespace dem {

/// Hands OpenImageIO's progress to a Run and brings its exceptions back.
class OiioProgress {
 public:
  OiioProgress(const Run& run, std::string what) : run_(run), what_(std::move(what)) {}

  /// Gives true to stop, as OpenImageIO wants it.
  static bool call(void* self, float part) {
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

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const Run& run_;
  std::string what_;
  std::exception_ptr error_;
};

/// An OpenImageIO message on one line.
inline std::string one_line(std::string message) {
  std::ranges::replace(message, '\n', ' ');
  return message;
}

}  // namespace dem
