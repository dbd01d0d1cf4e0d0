#include "io/gdal_support.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>

#include "dem/io/rasters.h"

namespace dem::io {

void register_gdal() {
  static const bool done = (GDALAllRegister(), true);
  static_cast<void>(done);
}

std::string gdal_threads(const Run& run) {
  return run.threads > 0 ? fmt::format("{}", run.threads) : "ALL_CPUS";
}

GdalErrors::GdalErrors() {
  register_gdal();
  CPLErrorReset();
  CPLPushErrorHandlerEx(collect, this);
}

GdalErrors::~GdalErrors() { CPLPopErrorHandler(); }

void CPL_STDCALL GdalErrors::collect(CPLErr level, CPLErrorNum, const char* message) {
  const int cause = errno;
  auto& self = *static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
  if (level < CE_Failure || self.any()) return;
  self.first_ = message;
  std::ranges::replace(self.first_, '\n', ' ');
  if (cause == ENOSPC || cause == EFBIG || cause == EDQUOT)
    self.first_ += fmt::format(" ({})", std::strerror(cause));
}

void GdalErrors::fail(const std::string& path, const std::string& fallback) const {
  // GDAL often begins with the path, which the error names already.
  std::string cause = any() ? first_ : fallback;
  for (const std::string& prefix : {path + ": ", "`" + path + "' "})
    if (cause.starts_with(prefix)) cause.erase(0, prefix.size());
  // While it is written the file has another folder, which says nothing to anybody.
  std::string name = std::filesystem::path(path).filename().string();
  name = '/' + name + ": ";
  if (const auto at = cause.find(name); at != std::string::npos && cause.find(": ") > at)
    cause.erase(0, at + name.size());
  throw IoError(path, cause);
}

DatasetPtr wrap_cells(void* cells, int cols, int rows, GDALDataType type) {
  register_gdal();
  DatasetPtr dataset(GDALCreate(GDALGetDriverByName("MEM"), "", cols, rows, 0, type, nullptr));
  char pointer[64] = {};
  pointer[CPLPrintPointer(pointer, cells, sizeof pointer - 1)] = '\0';
  char option[96];
  std::snprintf(option, sizeof option, "DATAPOINTER=%s", pointer);
  char* options[] = {option, nullptr};
  if (!dataset || GDALAddBand(dataset.get(), type, options) != CE_None) throw std::bad_alloc();
  return dataset;
}

}  // namespace dem::io
