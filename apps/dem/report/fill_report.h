#pragma once
// What a report shows of a fill.

#include <string>

#include "dem/io/fill_job.h"
#include "report/page.h"

namespace dem::app {

/// Pictures, sizes of voids, the largest ones; sigma where there is some; the spectrum of a raster
/// in memory that has no voids left.
Json fill_sections(FillJob& job, const std::string& method, const Run& run);

/// Title, outcome and settings, to be completed with sections and files.
ReportPage fill_page(const std::string& in, const FillJob& job);

}  // namespace dem::app
