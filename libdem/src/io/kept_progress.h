#pragma once
// Progress through the callbacks of libraries that exceptions must not cross. Private to dem::io.

#include <exception>
#include <string>

#include "dem/run.h"

namespace dem::io {

class KeptProgress {
 public:
  KeptProgress(const Run& run, std::string what) : run_(run), what_(std::move(what)) {}

  /// Reports to the Run and keeps what it throws. Gives false when the work must stop.
  bool report(double part) noexcept {
    if (error_) return false;
    try {
      run_.report(part, what_);
      return true;
    } catch (...) {
      error_ = std::current_exception();
      return false;
    }
  }

  /// Throws what was kept, back on our side.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const Run& run_;
  std::string what_;
  std::exception_ptr error_;
};

}  // namespace dem::io
