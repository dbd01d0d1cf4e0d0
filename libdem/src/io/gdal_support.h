#pragma once
// GDAL's errors, progress and threads as this library has them. Private to dem::io.

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>

#include <memory>
#include <string>

#include "dem/run.h"
#include "io/kept_progress.h"

namespace dem::io {

/// Registers GDAL's drivers, once.
void register_gdal();

/// GDAL's number for Run::threads: "2", or "ALL_CPUS".
std::string gdal_threads(const Run& run);

/// While it lives, GDAL's messages of this thread come here and nowhere else. Those that arrive
/// when a file is closed count too: a full disk often shows only then.
class GdalErrors {
 public:
  GdalErrors();
  ~GdalErrors();
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  bool any() const { return !first_.empty(); }
  const std::string& first() const { return first_; }
  void clear() { first_.clear(); }

  /// Throws IoError with GDAL's cause, or `fallback` when GDAL gave none.
  [[noreturn]] void fail(const std::string& path, const std::string& fallback) const;

 private:
  static void CPL_STDCALL collect(CPLErr level, CPLErrorNum code, const char* message);

  std::string first_;
};

/// Hands GDAL's progress to a Run and brings its exceptions back across the C interface.
class GdalProgress : public KeptProgress {
 public:
  using KeptProgress::KeptProgress;
  static int CPL_STDCALL call(double part, const char*, void* self) {
    return static_cast<GdalProgress*>(self)->report(part) ? TRUE : FALSE;
  }
};

struct CloseDataset {
  void operator()(GDALDatasetH dataset) const { GDALClose(dataset); }
};
using DatasetPtr = std::unique_ptr<void, CloseDataset>;

/// A dataset in memory whose single band is the caller's own cells; they must outlive it.
DatasetPtr wrap_cells(void* cells, int cols, int rows, GDALDataType type);

}  // namespace dem::io
