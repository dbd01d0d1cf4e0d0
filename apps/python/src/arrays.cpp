#include "arrays.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem::python {
namespace {

std::string dtype_name(const py::array& array) { return py::str(array.dtype()); }

/// Reads cells of type T, whatever the strides.
template <class T>
void read_heights(const py::array& array, const Mask& asked, const std::optional<double>& nodata,
                  DemFile& file) {
  const auto values = array.unchecked<T, 2>();
  const Size size{int(values.shape(1)), int(values.shape(0))};
  Dem& dem = file.dem;
  dem.z = Raster<float>::unset(size);
  dem.known = Mask::unset(size);
  constexpr bool wide = sizeof(T) > 2 && !std::is_same_v<T, float>;
  if (wide) file.source.exact = Raster<double>::unset(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const T value = values(row, col);
      const bool is_number = std::isfinite(double(value));
      const bool known = (asked.empty() ? is_number : asked(col, row) != 0) &&
                         !(nodata && double(value) == *nodata);
      if (known && !is_number)
        throw std::invalid_argument(fmt::format(
            "known is true at row {}, column {}, but z is {} there", row, col, double(value)));
      if (known && std::abs(double(value)) > double(std::numeric_limits<float>::max()))
        throw std::invalid_argument(
            fmt::format("z = {} at row {}, column {}; must be a height within float32, or unknown",
                        double(value), row, col));
      dem.known(col, row) = known;
      dem.z(col, row) = known ? float(value) : 0;
      if (wide) file.source.exact(col, row) = known ? double(value) : 0;
    }
}

struct DTypeReader {
  CellType type;
  bool (*fits)(const py::array&);
  void (*read)(const py::array&, const Mask&, const std::optional<double>&, DemFile&);
};

template <class T>
constexpr DTypeReader reader(CellType type) {
  return {type, [](const py::array& a) { return py::isinstance<py::array_t<T>>(a); },
          read_heights<T>};
}

constexpr DTypeReader kReaders[] = {
    reader<float>(CellType::float32),      reader<double>(CellType::float64),
    reader<std::int16_t>(CellType::int16), reader<std::uint16_t>(CellType::uint16),
    reader<std::int8_t>(CellType::int8),   reader<std::uint8_t>(CellType::uint8),
    reader<std::int32_t>(CellType::int32), reader<std::uint32_t>(CellType::uint32)};

template <class T>
Mask read_mask(const py::array& array) {
  const auto values = array.unchecked<T, 2>();
  Mask mask = Mask::unset({int(values.shape(1)), int(values.shape(0))});
  for (int row = 0; row < mask.rows(); ++row)
    for (int col = 0; col < mask.cols(); ++col) mask(col, row) = values(row, col) != 0;
  return mask;
}

}  // namespace

void check_dimensions(const py::array& array, const char* name, int dimensions) {
  if (array.ndim() != dimensions)
    throw std::invalid_argument(fmt::format(
        "{} has {} dimension{}; must have {}", name, array.ndim(), array.ndim() == 1 ? "" : "s",
        dimensions == 2 ? "2, rows and columns" : std::to_string(dimensions)));
  if (array.size() == 0)
    throw std::invalid_argument(fmt::format("{} is empty; must have at least one value", name));
  for (int d = 0; d < dimensions; ++d)
    if (array.shape(d) > std::numeric_limits<int>::max())
      throw std::invalid_argument(fmt::format(
          "{} has {} values along axis {}; must be less than 2^31", name, array.shape(d), d));
}

Mask mask_from_array(const py::array& array, const char* name) {
  check_dimensions(array, name, 2);
  if (py::isinstance<py::array_t<bool>>(array)) return read_mask<bool>(array);
  if (py::isinstance<py::array_t<std::uint8_t>>(array)) return read_mask<std::uint8_t>(array);
  throw std::invalid_argument(
      fmt::format("{} has dtype {}; must be bool or uint8", name, dtype_name(array)));
}

DemFile dem_from_arrays(const py::array& z, const py::object& known,
                        const std::optional<double>& nodata) {
  check_dimensions(z, "z", 2);
  Mask asked;
  if (!known.is_none()) {
    const auto array = py::array::ensure(known);
    if (!array) throw py::error_already_set();
    asked = mask_from_array(array, "known");
    if (asked.rows() != z.shape(0) || asked.cols() != z.shape(1))
      throw std::invalid_argument(fmt::format("known has shape ({}, {}); must be ({}, {}), as z",
                                              asked.rows(), asked.cols(), z.shape(0), z.shape(1)));
  }
  for (const DTypeReader& reader : kReaders)
    if (reader.fits(z)) {
      DemFile file;
      file.source.type = reader.type;
      file.source.nodata = nodata;
      reader.read(z, asked, nodata, file);
      return file;
    }
  throw std::invalid_argument(fmt::format(
      "z has dtype {}; must be float32, float64 or an integer of up to 32 bits", dtype_name(z)));
}

}  // namespace dem::python
