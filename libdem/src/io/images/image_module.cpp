#include "io/images/image_module.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <stdlib.h>

#include <filesystem>
#include <string_view>

#include "dem/io/rasters.h"

namespace dem::io {
namespace {

namespace fs = std::filesystem;

/// The folder of the program or shared library that this code was linked into.
fs::path own_folder() {
  Dl_info info;
  void* extra = nullptr;
  std::error_code error;
  const auto address = reinterpret_cast<const void*>(&image_module);
  if (!dladdr1(address, &info, &extra, RTLD_DL_LINKMAP)) return {};
  const std::string_view name = static_cast<const link_map*>(extra)->l_name;
  const fs::path file = name.empty() ? fs::path("/proc/self/exe") : fs::path(name);
  return fs::canonical(file, error).parent_path();
}

/// Where the module may lie: in the folder that DEM_MODULES names, else beside us or as installed.
std::vector<fs::path> folders() {
  const char* asked = getenv("DEM_MODULES");
  if (asked && *asked) return {asked};
  std::vector<fs::path> list;
  if (const fs::path own = own_folder(); !own.empty())
    list = {own, own / "libdem", (own / DEM_MODULES_FROM_PROGRAM).lexically_normal()};
  list.emplace_back(DEM_MODULES_INSTALLED);
  return list;
}

/// The module's file: a path, or the bare name, which the dynamic linker seeks along its own paths.
std::string find_file(const std::vector<fs::path>& where) {
  std::error_code ignored;
  for (const fs::path& folder : where)
    if (fs::exists(folder / DEM_IMAGE_MODULE, ignored)) return (folder / DEM_IMAGE_MODULE).string();
  return DEM_IMAGE_MODULE;
}

const ImageModule& load() {
  const std::vector<fs::path> where = folders();
  const std::string file = find_file(where);
  const bool found = file != DEM_IMAGE_MODULE;
  const bool asked = where.size() == 1;
  void* module = asked && !found ? nullptr : dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (!module && !found) {
    std::string list;
    for (const fs::path& folder : where) list += (list.empty() ? "" : ", ") + folder.string();
    throw IoError(DEM_IMAGE_MODULE,
                  fmt::format("the module that reads and draws images is not in {}; install the "
                              "package libdem, or set DEM_MODULES to the folder that holds it",
                              list));
  }
  if (!module)
    throw IoError(file, fmt::format("cannot be loaded ({}); install OpenImageIO {} (on Debian the "
                                    "package {})",
                                    dlerror(), DEM_OPENIMAGEIO_VERSION, DEM_OPENIMAGEIO_PACKAGE));
  using Get = const ImageModule* (*)();
  const auto get = reinterpret_cast<Get>(dlsym(module, DEM_IMAGE_MODULE_SYMBOL));
  if (!get)
    throw IoError(file, fmt::format("is the module of another version of libdem, not of {}; "
                                    "install the package libdem of this version",
                                    DEM_VERSION));
  return *get();
}

}  // namespace

const ImageModule& image_module() {
  static const ImageModule& module = load();
  return module;
}

}  // namespace dem::io
