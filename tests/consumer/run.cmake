# Installs libdem from a build into an empty prefix, builds the consumer against it, and runs it.
#
#   cmake -DBUILD=... -DCONSUMER=... -DWORK=... -DIO=ON|OFF [-DLIBDIR=...] -P run.cmake
#
# BUILD: a build of libdem, or with SOURCE=... the folder where one is made first.
# WORK: a folder of its own, emptied first. IO: whether dem::io is wanted; then also the program of
# docs/c.md is compiled as C99, found by pkg-config below LIBDIR, and compared with `dem fill`.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
if(SOURCE)
  run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${BUILD} -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_CXX_FLAGS_RELEASE=-O1 -DDEM_BUILD_IO=${IO} -DDEM_BUILD_TESTS=OFF -DDEM_BUILD_BENCH=OFF
      -DCMAKE_DISABLE_FIND_PACKAGE_GDAL=ON)
  run(${CMAKE_COMMAND} --build ${BUILD})
endif()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -G Ninja -S ${CONSUMER} -B ${WORK}/build -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCONSUMER_IO=${IO})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
if(IO)
  run(${WORK}/build/consumer_io ${WORK}/hole.tif)

  file(READ ${CONSUMER}/../../docs/c.md page)
  if(NOT page MATCHES "```c\n([^`]*)```")
    message(FATAL_ERROR "docs/c.md has no C program")
  endif()
  file(WRITE ${WORK}/fill.c "${CMAKE_MATCH_1}")
  set(ENV{PKG_CONFIG_PATH} ${WORK}/prefix/${LIBDIR}/pkgconfig)
  execute_process(COMMAND pkg-config --cflags --libs dem OUTPUT_VARIABLE flags
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags)
  run(cc -std=c99 -Wall -Wextra -Wpedantic -Werror ${WORK}/fill.c -o ${WORK}/fill ${flags})
  set(dem ${WORK}/prefix/bin/dem)
  set(tile ${CONSUMER}/../../testdata/jacksboro.tif)
  run(${dem} sample ${tile} ${WORK}/voids.tif --voids 5%)
  run(${WORK}/fill ${WORK}/voids.tif ${WORK}/c.tif ${WORK}/c_sigma.tif)
  run(${dem} fill ${WORK}/voids.tif ${WORK}/cli.tif --sigma ${WORK}/cli_sigma.tif)
  run(${dem} evaluate ${WORK}/cli.tif ${WORK}/c.tif --expect max<=0)
  run(${dem} evaluate ${WORK}/cli_sigma.tif ${WORK}/c_sigma.tif --expect max<=0)
endif()
