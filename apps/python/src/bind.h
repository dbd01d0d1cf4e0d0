#pragma once
// The parts of the module `libdem._core`. They take Dem objects and settings as text; the package's
// Python side turns arrays and keywords into these.

#include <pybind11/pybind11.h>

namespace dem::python {

void bind_dem(pybind11::module_& module);      // Dem, read, write
void bind_tables(pybind11::module_& module);   // methods, generators, fields
void bind_fill(pybind11::module_& module);     // fill, supersample
void bind_points(pybind11::module_& module);   // grid
void bind_terrain(pybind11::module_& module);  // sample, generate, erode
void bind_measure(pybind11::module_& module);  // evaluate, render
void bind_mosaic(pybind11::module_& module);   // SharedRaster, for libdem.distributed

}  // namespace dem::python
