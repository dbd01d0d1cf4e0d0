#include "io/staged_file.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "dem/io/rasters.h"

namespace dem::io {
namespace fs = std::filesystem;

std::string extension(const std::string& path) {
  std::string e = fs::path(path).extension().string();
  std::ranges::transform(e, e.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return e;
}

StagedFile::StagedFile(const std::string& path, bool overwrite)
    : asked_(path), overwrite_(overwrite) {
  if (path.starts_with("/vsi")) throw IoError(path, "only plain files can be written");
  std::error_code error;
  const bool link = fs::is_symlink(path, error);  // an error here says: no such file, or no access
  target_ = link ? fs::weakly_canonical(path, error) : fs::path(path);
  if (target_.filename().empty()) throw IoError(path, "is not the name of a file");

  const fs::file_status status = fs::status(target_, error);
  if (fs::is_directory(status))
    throw IoError(path, "is a folder; .hgt tiles go into it when it ends in /");
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) throw IoError(path, "is not a regular file");
    if (!overwrite)
      throw IoError(path, "exists, and overwriting it was not asked for", "overwrite");
  }

  // The folder is tried, not asked: permissions alone do not tell.
  const fs::path parent = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  if (!fs::exists(parent, error))
    throw IoError(path, fmt::format("its folder {} does not exist", parent.string()));
  std::string name = (parent / fmt::format(".{}.XXXXXX", target_.filename().string())).string();
  if (!mkdtemp(name.data()))
    throw IoError(path, fmt::format("its folder {} cannot be written: {}", parent.string(),
                                    std::strerror(errno)));
  folder_ = name;
}

StagedFile::~StagedFile() {
  std::error_code ignored;  // a destructor cannot report, and the outcome is known by now
  fs::remove_all(folder_, ignored);
}

void StagedFile::write(std::span<const char> bytes) {
  errno = 0;
  std::ofstream out(path(), std::ios::binary);
  out.write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  if (!out) throw IoError(asked_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

void StagedFile::commit() {
  const fs::path name = target_.filename();
  const auto place = [&](const fs::path& file) { return target_.parent_path() / file; };
  const auto ours = [&](const fs::path& file) {
    return file.string().starts_with(name.string() + ".");
  };
  try {
    // A sidecar under another name ("a.prj" of "a.asc") may be someone else's.
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const fs::path file = entry.path().filename();
      if (file != name && !ours(file) && !overwrite_ && fs::exists(place(file)))
        throw IoError(place(file).string(), "exists, and overwriting it was not asked for",
                      "overwrite");
    }

    // Sidecars of the file that was there would be read as those of the new one.
    for (const char* suffix : {".aux.xml", ".ovr", ".msk"}) {
      const fs::path sidecar = name.string() + suffix;
      if (!fs::exists(folder_ / sidecar)) fs::remove(place(sidecar));
    }
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().filename() != name) fs::rename(entry.path(), place(entry.path().filename()));
    fs::rename(folder_ / name, target_);
  } catch (const fs::filesystem_error& error) {
    throw IoError(asked_, "cannot be put in place: " + error.code().message());
  }
}

}  // namespace dem::io

namespace dem {

void write_text(const std::string& path, const std::string& text, bool overwrite) {
  io::StagedFile staged(path, overwrite);
  staged.write(text);
  staged.commit();
}

}  // namespace dem
