#pragma once
// Which cells of a file hold no elevation, and what says so. Private to dem::io.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dem/io/rasters.h"

namespace dem::io {

/// Looks through the raw values of a file, row by row.
class NodataSearch {
 public:
  /// `declared`: the file's own no-data value and where it is said ("declared value", ".hgt void").
  /// `metres_per_unit`: of one raw unit, for the rule about isolated values.
  NodataSearch(std::optional<double> declared, std::string declared_as, const ReadOptions& options,
               double metres_per_unit = 1);

  /// Clears `known` where a value says nothing; cells that come in as 0 were masked by the file.
  /// Unknown values become 0.
  template <class T>
  void scan_row(std::span<T> values, std::span<std::uint8_t> known);

  /// After all rows: clears the undeclared sentinels that stand isolated. Call once.
  template <class T>
  void clear_sentinels(std::span<T> values, std::span<std::uint8_t> known);

  void count_masked(std::uint64_t cells) { masked_ += cells; }

  std::optional<double> value() const { return value_; }  ///< the one that stands for "unknown"
  std::vector<NodataEvidence> evidence() const;
  std::vector<double> undeclared() const;  ///< values that clear_sentinels() takes as unknown

 private:
  struct Sentinel {
    double value;
    std::uint64_t cells = 0;
    bool has_neighbour = false;  // another elevation lies within 500 m
    bool used() const { return cells > 0 && !has_neighbour; }
  };

  template <class T>
  void classify_unknown(T value);
  void look_for_sentinels(double value);

  std::optional<double> value_, overridden_;
  std::string value_as_;
  bool detect_;
  double near_;  // 500 m in raw units
  std::array<Sentinel, 4> sentinels_{{{-32768}, {-32767}, {-9999}, {32767}}};
  std::uint64_t valued_ = 0, nan_ = 0, infinite_ = 0, huge_ = 0, masked_ = 0;
};

}  // namespace dem::io
