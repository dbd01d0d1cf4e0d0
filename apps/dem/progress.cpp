#include "progress.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace dem::app {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // may be set in a signal handler

void on_stop_signal(int) { stop = true; }

std::string duration(double seconds) {
  const int s = int(seconds + 0.5);
  return s < 60 ? fmt::format("{} s", s) : fmt::format("{} min {:02} s", s / 60, s % 60);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGXFSZ, SIG_IGN);
  signal(SIGPIPE, SIG_DFL);
}

bool stop_requested() { return stop; }

Progress::Style Progress::style_of(const std::string& name, bool quiet) {
  if (name == "bar") return Style::bar;
  if (name == "json") return Style::json;
  return name == "auto" && !quiet && isatty(STDERR_FILENO) ? Style::bar : Style::none;
}

void Progress::start(Style style) {
  style_ = style;
  start_ = last_ = Clock::now();
}

bool Progress::report(double part, std::string_view what) {
  const auto now = Clock::now();
  if (style_ != Style::none && now - last_ >= std::chrono::milliseconds(100)) {
    last_ = now;
    part = std::clamp(part, 0.0, 1.0);
    if (style_ == Style::bar)
      draw_bar(part, what, std::chrono::duration<double>(now - start_).count());
    else
      fmt::print(stderr, "{}\n",
                 nlohmann::ordered_json{{"part", part}, {"what", std::string(what)}}.dump());
    std::fflush(stderr);
  }
  return !stop;
}

void Progress::draw_bar(double part, std::string_view what, double seconds) {
  constexpr int width = 28;
  const int full = int(part * width);
  std::string left;
  if (seconds > 2 && part > 0.02) left = ", " + duration(seconds / part * (1 - part)) + " left";
  fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %{}  {}", std::string(std::size_t(full), '#'),
             std::string(std::size_t(width - full), '.'), 100 * part, left, what.substr(0, 32));
  drawn_ = true;
}

void Progress::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace dem::app
