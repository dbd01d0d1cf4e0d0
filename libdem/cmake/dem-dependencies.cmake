# The libraries that dem::dem links. Read by the build and, installed, by find_package(libdem).
include(CMakeFindDependencyMacro)
find_dependency(TBB)
find_dependency(fmt)
