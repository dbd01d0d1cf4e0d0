#pragma once
// numpy arrays in and out.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <utility>

#include "dem/io/rasters.h"

namespace dem::python {

namespace py = pybind11;

/// A DEM from an array of heights, copied once: float32, float64 or an integer of up to 32 bits,
/// any strides. Unknown: where `known` (an array of its shape, or None) is 0, where z is no finite
/// number, and where it is `nodata`. Values that float32 may not hold are kept as Source::exact.
/// Throws std::invalid_argument that says what is wrong with the arrays.
DemFile dem_from_arrays(const py::array& z, const py::object& known,
                        const std::optional<double>& nodata);

/// A mask from an array of numbers or booleans: 1 where it is not 0.
Mask mask_from_array(const py::array& values, const char* name);

/// Throws std::invalid_argument unless the array has `dimensions` and at least one value.
void check_dimensions(const py::array& values, const char* name, int dimensions);

/// The raster's cells as an array that owns them: no copy.
template <class T>
py::array array_from(Raster<T>&& raster) {
  auto owner = std::make_unique<Raster<T>>(std::move(raster));
  const py::ssize_t rows = owner->rows(), cols = owner->cols();
  T* const cells = owner->cells().data();
  const py::capsule keep(owner.release(), [](void* p) { delete static_cast<Raster<T>*>(p); });
  return py::array_t<T>({rows, cols}, cells, keep);
}

/// The standard errors as such an array; None when there are none.
inline py::object sigma_array(Raster<float>&& sigma) {
  return sigma.empty() ? py::object(py::none()) : py::object(array_from(std::move(sigma)));
}

/// The raster's cells as an array that lives with `owner`: no copy.
template <class T>
py::array array_view(Raster<T>& raster, const py::handle& owner) {
  return py::array_t<T>({py::ssize_t(raster.rows()), py::ssize_t(raster.cols())},
                        raster.cells().data(), owner);
}

}  // namespace dem::python
