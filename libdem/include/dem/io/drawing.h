#pragma once
// Inputs of generators from files: drawings from vector layers. Also a filter that smooths
// generated terrain.

#include <string>

#include "dem/canvas.h"
#include "dem/raster.h"
#include "dem/run.h"

namespace dem {

/// Whether GDAL opens the file as vector data and not as a raster.
bool is_vector_file(const std::string& path);

/// Draws the lines and polygons of a vector layer as an image for a generator.
/// The grey of a feature is its field `grey` (0 black to 1 white), or follows from its field
/// `kind`: ridge 0.75, river 0.25, land 1, rocks 0.5, sea 0. Later features cover earlier ones.
/// Cells that nothing covers are black where the layer has polygons, and white otherwise. Lines of
/// kind ridge that have the fields height_m and width_m (half of the foot) are also returned as
/// ridges.
/// Needs:  a file with this layer only, with coordinates in the system of the canvas.
/// Throws: IoError.
Drawing draw_vectors(const std::string& path, const Canvas& canvas);

/// Replaces each height by the median of the side x side cells around it, `passes` times. At the
/// border, the median is that of the cells inside the raster. OpenImageIO computes it.
/// Throws: std::invalid_argument unless side is odd and from 1 to 255, and passes from 0 to 100.
Raster<float> median_filter(const Raster<float>& z, int side = 5, int passes = 1,
                            const Run& run = {});

}  // namespace dem
