#pragma once
// How a call runs: threads and progress. Neither changes a bit of any result.

#include <functional>
#include <stdexcept>
#include <string_view>

namespace dem {

/// Thrown when the progress callback asked to stop. No result, nothing half-done.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

struct Run {
  int threads = 0;  ///< 0: as many as the machine has cores

  /// Called now and then, from the calling thread, with the part done (0 to 1) and what is being
  /// done; returning false stops the work, which then throws Cancelled.
  std::function<bool(double part, std::string_view what)> progress = {};

  /// Reports progress; throws Cancelled when the callback returns false.
  void report(double part, std::string_view what) const {
    if (progress && !progress(part, what)) throw Cancelled();
  }

  /// The same run, its progress scaled into [from, to]: for a step of a longer work.
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
