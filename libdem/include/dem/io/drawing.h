#pragma once
// What generators start from, from files: drawings out of vector layers; and the smoothing of what
// they make. Target dem::io.

#include <string>

#include "dem/canvas.h"
#include "dem/raster.h"
#include "dem/run.h"

namespace dem {

/// Whether GDAL opens the file as vector data and not as a raster.
bool is_vector_file(const std::string& path);

/// Draws the lines and polygons of a vector layer as an image for a generator: in the grey of
/// their field `grey` (0 black to 1 white), or that of their field `kind`: ridge 0.75, river 0.25,
/// land 1, rocks 0.5, sea 0. Later features cover earlier ones. What nothing covers is black where
/// there are polygons, else white. Lines of kind ridge that have fields height_m and width_m (half
/// of the foot) are given back as ridges as well.
/// Needs:    the layer alone in its file, with coordinates in the canvas's system.
/// Throws:   IoError.
Drawing draw_vectors(const std::string& path, const Canvas& canvas);

/// Each height as the median of the side x side cells around it, `passes` times (OpenImageIO's;
/// at the rim, of the cells there are).
/// Throws:   std::invalid_argument unless side is odd, 1 to 255, and passes 0 to 100.
Raster<float> median_filter(const Raster<float>& z, int side = 5, int passes = 1,
                            const Run& run = {});

}  // namespace dem
