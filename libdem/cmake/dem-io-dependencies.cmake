# The libraries that dem::io links. Read by the build and, installed, by find_package(libdem).
include(CMakeFindDependencyMacro)
find_dependency(GDAL CONFIG)

# Debian ships GeographicLib without a CMake package.
if(NOT TARGET dem::GeographicLib)
  find_path(GEOGRAPHICLIB_INCLUDE_DIR GeographicLib/Geodesic.hpp REQUIRED)
  find_library(GEOGRAPHICLIB_LIBRARY NAMES GeographicLib Geographic REQUIRED)
  add_library(dem::GeographicLib UNKNOWN IMPORTED)
  set_target_properties(dem::GeographicLib PROPERTIES
    IMPORTED_LOCATION ${GEOGRAPHICLIB_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${GEOGRAPHICLIB_INCLUDE_DIR})
endif()
