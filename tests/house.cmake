# Tests of the house around the code: format, layers, and that others can use what is installed.
# They do not depend on compiler or build type, so one build runs them.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

add_test(NAME house.format COMMAND ${PROJECT_SOURCE_DIR}/scripts/check_format.sh)
add_test(NAME house.layers
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_layers.py)
add_test(NAME house.layers_check_finds_planted_violations
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_layers.py --self-test)
add_test(NAME house.lines
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_lines.py)
add_test(NAME house.lines_check_finds_planted_lines
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/check_lines.py --self-test)

# The objects stay in build/.../odr, so that a second run compiles only what has changed.
add_test(NAME house.odr
         COMMAND ${PROJECT_SOURCE_DIR}/scripts/check_odr.sh ${PROJECT_BINARY_DIR}/odr)
set_tests_properties(house.odr PROPERTIES LABELS slow TIMEOUT 1800)
add_test(NAME house.odr_check_finds_a_planted_violation
         COMMAND ${PROJECT_SOURCE_DIR}/scripts/check_odr.sh --self-test)

# The consumer's own folder is build/.../tests/consumer*, so nothing outside the build is touched.
add_test(NAME house.consumer_without_gis
         COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR}
                 -DBUILD=${CMAKE_CURRENT_BINARY_DIR}/consumer_without_gis/libdem
                 -DWORK=${CMAKE_CURRENT_BINARY_DIR}/consumer_without_gis/work
                 -DCONSUMER=${CMAKE_CURRENT_SOURCE_DIR}/consumer -DIO=OFF
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/run.cmake)
if(DEM_BUILD_IO AND DEM_BUILD_APPS AND NOT DEM_SANITIZE)
  add_test(NAME house.docs
           COMMAND ${PROJECT_SOURCE_DIR}/scripts/docs.sh --check $<TARGET_FILE:dem_cli>)
  add_test(NAME house.tutorial
           COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/run_page.py
                   ${PROJECT_SOURCE_DIR}/docs/tutorial.md $<TARGET_FILE:dem_cli>)
  set(docs_tests house.docs house.tutorial)
endif()
set(fast_tests house.format house.layers house.layers_check_finds_planted_violations house.lines
    house.lines_check_finds_planted_lines)
set(house_tests ${docs_tests} house.odr_check_finds_a_planted_violation
    house.consumer_without_gis)
if(DEM_BUILD_IO AND NOT DEM_SANITIZE)
  add_test(NAME house.consumer
           COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR}
                   -DWORK=${CMAKE_CURRENT_BINARY_DIR}/consumer
                   -DCONSUMER=${CMAKE_CURRENT_SOURCE_DIR}/consumer -DIO=ON
                   -DLIBDIR=${CMAKE_INSTALL_LIBDIR}
                   -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer/run.cmake)
  list(APPEND house_tests house.consumer)
  if(DEM_BUILD_APPS)
    add_test(NAME house.package COMMAND Python3::Interpreter
             ${CMAKE_CURRENT_SOURCE_DIR}/package.py ${PROJECT_BINARY_DIR})
    list(APPEND house_tests house.package)
  endif()
endif()
set_tests_properties(${fast_tests} PROPERTIES LABELS fast)
set_tests_properties(${house_tests} PROPERTIES LABELS house TIMEOUT 600)

# Builds a copy of the tree with one more method; the copy is kept, so that later runs are short.
if(DEM_BUILD_IO AND DEM_BUILD_APPS AND NOT DEM_SANITIZE)
  add_test(NAME doors.planted_method COMMAND Python3::Interpreter
           ${CMAKE_CURRENT_SOURCE_DIR}/planted_method.py ${CMAKE_CURRENT_BINARY_DIR}/planted)
  set_tests_properties(doors.planted_method PROPERTIES LABELS doors TIMEOUT 1200)
endif()
