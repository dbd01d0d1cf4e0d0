#pragma once
// How a call runs: threads and progress. Neither changes a bit of any result.

#include <functional>
#include <stdexcept>
#include <string_view>

namespace dem {

/// Thrown when the progress callback returned false. There is no result.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

struct Run {
  int threads = 0;  ///< 0: as many as the machine has cores

  /// Called from time to time, from the calling thread, with the part done (0 to 1) and the name of
  /// the current step. If it returns false, the work stops and throws Cancelled.
  std::function<bool(double part, std::string_view what)> progress = {};

  /// Reports progress; throws Cancelled when the callback returns false.
  void report(double part, std::string_view what) const {
    if (progress && !progress(part, what)) throw Cancelled();
  }

  /// The same run with its progress scaled into [from, to], for a step of a longer task.
  Run part(double from, double to) const {
    Run sub{threads, {}};
    if (progress)
      sub.progress = [p = progress, from, to](double part, std::string_view what) {
        return p(from + part * (to - from), what);
      };
    return sub;
  }
};

}  // namespace dem
