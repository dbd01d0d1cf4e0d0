#pragma once
// How Python calls the library: without the interpreter's lock, and stoppable.

#include <pybind11/pybind11.h>

#include <chrono>
#include <optional>

#include "dem/run.h"

namespace dem::python {

namespace py = pybind11;

/// Runs `work(run)` with the lock released. While it runs, signals are looked at (Ctrl-C raises
/// KeyboardInterrupt) and `progress(part, what)` is called, twenty times a second at most; what it
/// raises stops the work and is raised again, and so is KeyboardInterrupt when it returns False.
class Call {
 public:
  Call(int threads, py::object progress) : threads_(threads), progress_(std::move(progress)) {}

  template <class Work>
  auto operator()(const Work& work) {
    try {
      const py::gil_scoped_release unlocked;
      return work(
          Run{threads_, [this](double part, std::string_view what) { return report(part, what); }});
    } catch (const Cancelled&) {
      if (raised_) throw std::move(*raised_);
      throw;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  bool report(double part, std::string_view what) {
    constexpr auto interval = std::chrono::milliseconds(50);
    const auto now = Clock::now();
    if (now - last_ < interval) return true;
    last_ = now;
    const py::gil_scoped_acquire locked;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      return progress_.is_none() ||
             !progress_(part, py::str(what.data(), what.size())).is(py::bool_(false));
    } catch (py::error_already_set& error) {
      raised_.emplace(std::move(error));
      return false;
    }
  }

  int threads_;
  py::object progress_;
  Clock::time_point last_{};
  std::optional<py::error_already_set> raised_;
};

}  // namespace dem::python
