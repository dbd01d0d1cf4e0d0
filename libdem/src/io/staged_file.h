#pragma once
// Files that appear whole or not at all. Private to dem::io.

#include <filesystem>
#include <span>
#include <string>

namespace dem::io {

/// The extension of a path in lower case, with its dot: ".tif", or "".
std::string extension(const std::string& path);

/// A file being written in a hidden folder beside its final name, under the name it will have, so
/// that format drivers may put their sidecars next to it. commit() moves all of it into place;
/// without it nothing remains.
class StagedFile {
 public:
  /// Throws IoError when `path` exists and may not be overwritten, or its folder takes no file.
  StagedFile(const std::string& path, bool overwrite);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// Where to write.
  std::string path() const { return (folder_ / target_.filename()).string(); }

  /// Writes the whole file. Throws IoError.
  void write(std::span<const char> bytes);

  /// Renames sidecars, then the file itself. Throws IoError.
  void commit();

 private:
  std::string asked_;             // as the caller named it, for messages
  std::filesystem::path target_;  // symbolic links resolved: the link itself must survive
  std::filesystem::path folder_;
  bool overwrite_;
};

}  // namespace dem::io
