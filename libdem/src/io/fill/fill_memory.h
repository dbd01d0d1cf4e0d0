#pragma once
// What filling part by part takes of the memory. Private to dem::io.

#include <cstddef>

#include "dem/fill.h"
#include "dem/io/fill_files.h"
#include "dem/io/raster_stream.h"

namespace dem::io {

constexpr std::size_t mega = std::size_t{1} << 20;

/// Code, libraries, small things; and what GDAL may keep of all files.
constexpr std::size_t program_bytes = 96 * mega;
std::size_t block_cache(std::size_t memory);

/// Bytes that a fill takes for each cell of a window, its input and result included.
std::size_t bytes_a_cell(const FillOptions& options, const FillFiles& files);

/// A raster file, box by box; `spacing`: of each row. Both must outlive it.
FillRaster raster_of(RasterReader& reader, const std::vector<Spacing>& spacing);

}  // namespace dem::io
