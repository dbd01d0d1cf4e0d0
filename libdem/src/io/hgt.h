#pragma once
// SRTM's .hgt: a square of big-endian int16 heights, sampled at nodes one degree edge to edge.
// Private to dem::io.

#include <string>

#include "dem/io.h"

namespace dem {

/// Whether the name ends in .hgt, .hgt.gz or .hgt.zip (in any case).
bool is_hgt_name(const std::string& path);

DemFile read_hgt(const std::string& path, const ReadOptions& options, const Run& run);
void write_hgt(const std::string& path, const Dem& dem, const WriteOptions& options,
               const Run& run);

}  // namespace dem
