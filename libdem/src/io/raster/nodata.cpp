#include "io/raster/nodata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem::io {
namespace {

// Beyond this no number is an elevation, in whatever unit: rasters use the lowest float as "none".
constexpr double kHuge = 1e30;

// What was called undeclared no-data must be far from every elevation.
constexpr double kIsolation_m = 500;

template <class T>
bool equals(T value, double nodata) {
  if (std::abs(nodata) >= kHuge)  // often declared with fewer digits than stored
    return std::abs(double(value) - nodata) <= 1e-5 * std::abs(nodata);
  return value == T(nodata);
}

}  // namespace

NodataSearch::NodataSearch(std::optional<double> declared, std::string declared_as,
                           const ReadOptions& options, double metres_per_unit)
    : value_(declared),
      value_as_(std::move(declared_as)),
      detect_(options.detect_nodata),
      near_(kIsolation_m / metres_per_unit) {
  if (!declared) value_as_.clear();
  if (!options.nodata) return;
  if (declared && *declared != *options.nodata) overridden_ = declared;
  value_ = options.nodata;
  value_as_ = "given value";
}

template <class T>
void NodataSearch::classify_unknown(T value) {
  if (value_ && (equals(value, *value_) || (std::isnan(value) && std::isnan(*value_))))
    ++valued_;
  else if (std::isnan(value))
    ++nan_;
  else if (std::isinf(value))
    ++infinite_;
  else
    ++huge_;
}

void NodataSearch::look_for_sentinels(double value) {
  for (Sentinel& s : sentinels_)
    if (value == s.value) {
      ++s.cells;
      return;
    }
  for (Sentinel& s : sentinels_)
    if (std::abs(value - s.value) <= near_) s.has_neighbour = true;
}

template <class T>
void NodataSearch::scan_row(std::span<T> values, std::span<std::uint8_t> known) {
  const bool has_value = value_ && !std::isnan(*value_) && std::abs(*value_) < kHuge;
  const T nodata = has_value ? T(*value_) : std::numeric_limits<T>::quiet_NaN();  // equals nothing
  const T huge = T(kHuge);
  std::size_t unknown = 0;
  T low = std::numeric_limits<T>::max(), high = std::numeric_limits<T>::lowest();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T v = values[i];
    const bool says_nothing = v == nodata || !(std::abs(v) < huge);
    if (known[i] && says_nothing) classify_unknown(v);
    known[i] = known[i] && !says_nothing;
    values[i] = known[i] ? v : T(0);
    unknown += !known[i];
    low = known[i] && v < low ? v : low;
    high = known[i] && v > high ? v : high;
  }
  // Far from every sentinel, as nearly all rows are: nothing to look for.
  if (unknown == values.size() || !detect_ ||
      (double(low) > -9999 + near_ && double(high) < 32767 - near_))
    return;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (known[i]) look_for_sentinels(double(values[i]));
}

template <class T>
void NodataSearch::clear_sentinels(std::span<T> values, std::span<std::uint8_t> known) {
  for (const Sentinel& s : sentinels_) {
    if (!s.used()) continue;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (known[i] && double(values[i]) == s.value) {
        known[i] = 0;
        values[i] = T(0);
      }
    if (!value_) value_ = s.value;
  }
}

std::vector<NodataEvidence> NodataSearch::evidence() const {
  std::vector<NodataEvidence> list;
  if (value_ && !value_as_.empty())
    list.push_back({fmt::format("{} {}", value_as_, *value_), valued_, true,
                    value_as_ == "given value" ? "asked for" : "the file says so"});
  if (overridden_)
    list.push_back({fmt::format("declared value {}", *overridden_), 0, false,
                    "another value was given; not looked for"});
  if (masked_) list.push_back({"mask band", masked_, true, "the file says so"});
  if (nan_) list.push_back({"NaN", nan_, true, "not a number"});
  if (infinite_) list.push_back({"infinity", infinite_, true, "not an elevation"});
  if (huge_) list.push_back({"beyond 1e30", huge_, true, "not an elevation"});
  for (const Sentinel& s : sentinels_)
    if (s.cells)
      list.push_back({fmt::format("undeclared {}", s.value), s.cells, s.used(),
                      s.used() ? "no elevation within 500 m of it"
                               : "other elevations lie within 500 m of it"});
  return list;
}

std::vector<double> NodataSearch::undeclared() const {
  std::vector<double> values;
  for (const Sentinel& s : sentinels_)
    if (s.used()) values.push_back(s.value);
  return values;
}

template void NodataSearch::scan_row(std::span<float>, std::span<std::uint8_t>);
template void NodataSearch::scan_row(std::span<double>, std::span<std::uint8_t>);
template void NodataSearch::clear_sentinels(std::span<float>, std::span<std::uint8_t>);
template void NodataSearch::clear_sentinels(std::span<double>, std::span<std::uint8_t>);

}  // namespace dem::io
