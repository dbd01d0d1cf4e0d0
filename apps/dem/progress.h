#pragma once
// Progress of long work on stderr, and the stop by a signal.

#include <chrono>
#include <string>
#include <string_view>

namespace dem::app {

/// SIGINT and SIGTERM ask the running work to stop; a second one ends the process at once.
/// Too large a file is an error of the write, not a signal.
void install_signal_handlers();

/// Whether a stop was asked for.
bool stop_requested();

class Progress {
 public:
  enum class Style { none, bar, json };

  /// "auto" is a bar on a terminal, else nothing.
  static Style style_of(const std::string& name, bool quiet);

  void start(Style style);

  /// Shows the part done, at most ten times a second; false once a stop was asked for.
  bool report(double part, std::string_view what);

  /// Takes the bar off the terminal.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(double part, std::string_view what, double seconds);

  Style style_ = Style::none;
  Clock::time_point start_{}, last_{};
  bool drawn_ = false;
};

}  // namespace dem::app
