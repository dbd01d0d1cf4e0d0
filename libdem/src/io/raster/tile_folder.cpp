#include "io/raster/tile_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <system_error>
#include <utility>

#include "dem/io/rasters.h"
#include "io/raster/hgt.h"
#include "io/staged_file.h"

namespace dem::io {
namespace fs = std::filesystem;

bool is_tile_folder(const std::string& path) { return path.ends_with('/'); }

bool is_list_of_files(const std::string& path) { return path.find('\n') != std::string::npos; }

std::vector<std::string> files_of_list(const std::string& path) {
  std::vector<std::string> files;
  std::istringstream lines(path);
  for (std::string line; std::getline(lines, line);) files.push_back(line);
  return files;
}

std::string tile_folder_of(const std::string& vrt) {
  return fs::path(vrt).replace_extension().string() + "_tiles/";
}

TileFolder::TileFolder(const std::string& path, bool overwrite)
    : path_(fs::path(path).parent_path()) {
  if (path.starts_with("/vsi")) throw IoError(path, "only plain files can be written");
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_directory(path_, error)) throw IoError(path, "is not a folder");
    for (const auto& entry : fs::directory_iterator(path_, error))
      if (!overwrite)
        throw IoError(path,
                      fmt::format("holds {}, and overwriting it was not asked for",
                                  entry.path().filename().string()),
                      "overwrite");
  } else {
    made_ = fs::create_directory(path_, error);
  }
  if (error) throw IoError(path, "cannot be made or read: " + error.message());
}

TileFolder::TileFolder(TileFolder&& other) noexcept
    : path_(std::move(other.path_)), made_(std::exchange(other.made_, false)) {}

TileFolder::~TileFolder() {
  std::error_code ignored;  // not empty, or gone: then it is no longer ours
  if (made_) fs::remove(path_, ignored);
}

}  // namespace dem::io

namespace dem {

std::vector<std::string> tiles_in(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const std::string ext = io::extension(name);
    const bool raster = io::is_hgt_name(name) || ext == ".tif" || ext == ".tiff";
    if (raster && !name.starts_with(".")) paths.push_back(entry.path().string());
  }
  if (error) throw IoError(folder, error.message());
  if (paths.empty()) throw IoError(folder, "is a folder that holds no .hgt and no .tif");
  std::ranges::sort(paths);
  return paths;
}

}  // namespace dem
