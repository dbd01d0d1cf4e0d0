// The module libdem._core.

#include <pybind11/pybind11.h>

#include "bind.h"
#include "dem/io/rasters.h"
#include "dem/run.h"

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
  module.doc() = "What the package libdem calls; use the package.";
  module.attr("version") = DEM_VERSION;
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const dem::IoError& e) {
      const std::string hint = e.field().empty() ? "" : " (" + e.field() + ")";
      PyErr_SetString(PyExc_OSError, (e.what() + hint).c_str());
    } catch (const dem::Cancelled&) {
      PyErr_SetString(PyExc_KeyboardInterrupt, "stopped by the progress callback");
    }
  });
  dem::python::bind_dem(module);
  dem::python::bind_tables(module);
  dem::python::bind_fill(module);
  dem::python::bind_points(module);
  dem::python::bind_terrain(module);
  dem::python::bind_measure(module);
  dem::python::bind_mosaic(module);
}
