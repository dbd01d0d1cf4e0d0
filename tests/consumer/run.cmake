# Installs libdem from a build into an empty prefix, builds the consumer against it, and runs it.
#
#   cmake -DBUILD=... -DCONSUMER=... -DWORK=... -DIO=ON|OFF -P run.cmake
#
# BUILD: a build of libdem, or with SOURCE=... the folder where one is made first.
# WORK: a folder of its own, emptied first. IO: whether dem::io is wanted.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
if(SOURCE)
  run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${BUILD} -DCMAKE_BUILD_TYPE=Release
      -DDEM_BUILD_IO=${IO} -DDEM_BUILD_TESTS=OFF -DDEM_BUILD_BENCH=OFF
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
endif()
