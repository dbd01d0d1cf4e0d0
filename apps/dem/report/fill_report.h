#pragma once
// What a report shows of a fill.

#include <functional>
#include <string>

#include "fill/hole_fill.h"
#include "report/page.h"

namespace dem::app {

/// A filled raster, whether it lies in memory or on disk.
struct FilledRaster {
  Size size;
  GeoRef ref;
  std::function<FilledPart(const Box&)> read;
  const Dem* whole = nullptr;  ///< when it lies in memory
};

/// What fill_holes_of left in memory, origins included. Lives no longer than the two.
FilledRaster filled_raster(const Dem& dem, const FillOutcome& out);

/// Pictures, sizes of holes, the largest ones; sigma where there is some; the spectrum of a raster
/// in memory that has no holes left.
Json fill_sections(const FillOutcome& out, const std::string& method, const FilledRaster& raster,
                   const Run& run);

/// Title, outcome and settings, to be completed with sections and files.
ReportPage fill_page(const std::string& in, const ChosenMethod& chosen, const FillOutcome& out);

}  // namespace dem::app
