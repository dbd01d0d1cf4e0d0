#pragma once
// A folder that takes the tiles of one raster. Private to dem::io.

#include <filesystem>
#include <string>
#include <vector>

namespace dem::io {

/// Whether a path is several paths, each on a line of its own.
bool is_list_of_files(const std::string& path);
std::vector<std::string> files_of_list(const std::string& path);

/// Whether a path to write to names a folder of tiles: it ends in a slash.
bool is_tile_folder(const std::string& path);

/// The folder beside "a.vrt" that holds its tiles: "a_tiles/".
std::string tile_folder_of(const std::string& vrt);

class TileFolder {
 public:
  /// Makes the folder unless it is there. Throws IoError when it is not empty and overwriting was
  /// not asked for, or cannot be made.
  TileFolder(const std::string& path, bool overwrite);
  ~TileFolder();  ///< takes the folder away again when it was made, and not kept
  TileFolder(TileFolder&& other) noexcept;
  TileFolder& operator=(TileFolder&&) = delete;

  std::string path() const { return path_.string(); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  void keep() { made_ = false; }

 private:
  std::filesystem::path path_;
  bool made_ = false;
};

}  // namespace dem::io
