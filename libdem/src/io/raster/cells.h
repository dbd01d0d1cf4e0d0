#pragma once
// Heights to the cell type of a file. Private to dem::io.

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>

#include "dem/io/rasters.h"

namespace dem::io {

/// Rounded half away from zero for integers, else as it is; `ok` turns false outside the type.
template <class T>
T to_cell(double height, bool& ok) {
  if constexpr (std::is_integral_v<T>) {
    const double rounded = std::trunc(height + std::copysign(0.5, height));
    // Adding a half can cross to the next integer only where a double has no halves left, or for
    // the one number just below 0.5.
    const double value = std::abs(rounded - height) <= 0.5 ? rounded : std::trunc(height);
    ok &= value >= double(std::numeric_limits<T>::min()) &&
          value <= double(std::numeric_limits<T>::max());
    return ok ? T(value) : T(0);
  } else {
    return T(height);
  }
}

/// Fills `out` from heights, unknown cells with `nodata`. Where `exact` (may be empty) still rounds
/// to the height, it is the height. Gives false when a known cell becomes `nodata`.
/// Throws IoError when a height does not fit the type.
template <class T>
bool to_cells(const std::string& path, std::span<const float> z, std::span<const double> exact,
              std::span<const std::uint8_t> known, T nodata, std::span<T> out) {
  bool collision = false;
  for (std::size_t i = 0; i < z.size(); ++i) {
    bool ok = true;
    const double height = !exact.empty() && float(exact[i]) == z[i] ? exact[i] : double(z[i]);
    const T cell = known[i] ? to_cell<T>(height, ok) : nodata;
    if (!ok)
      throw IoError(path,
                    fmt::format("elevation {} does not fit the type, {} to {}", height,
                                std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()));
    collision |= known[i] && cell == nodata;
    out[i] = cell;
  }
  return !collision;
}

/// Calls a function with a value of the C++ type that a cell type stands for.
template <class Call>
auto with_type(CellType type, const Call& call) {
  switch (type) {
    case CellType::int8:
      return call(std::int8_t{});
    case CellType::uint8:
      return call(std::uint8_t{});
    case CellType::int16:
      return call(std::int16_t{});
    case CellType::uint16:
      return call(std::uint16_t{});
    case CellType::int32:
      return call(std::int32_t{});
    case CellType::uint32:
      return call(std::uint32_t{});
    case CellType::float32:
      return call(float{});
    case CellType::float64:
      break;
  }
  return call(double{});
}

}  // namespace dem::io
