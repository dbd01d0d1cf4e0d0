# Writes the pages of the manual, packed for man, and the completion of each shell, as the program
# itself tells them.
#
#   cmake -DDEM=.../dem -DOUT=FOLDER -P write.cmake
function(dem output)
  execute_process(COMMAND ${DEM} ${ARGN} OUTPUT_FILE ${output} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT}/man1)
execute_process(COMMAND ${DEM} methods --json OUTPUT_VARIABLE tables COMMAND_ERROR_IS_FATAL ANY)
string(JSON verbs GET "${tables}" verbs)
string(JSON count LENGTH "${verbs}")
math(EXPR last "${count} - 1")
set(pages ${OUT}/man1/dem.1)
dem(${OUT}/man1/dem.1 manual)
foreach(i RANGE ${last})
  string(JSON verb GET "${verbs}" ${i} name)
  dem(${OUT}/man1/dem-${verb}.1 manual ${verb})
  list(APPEND pages ${OUT}/man1/dem-${verb}.1)
endforeach()
execute_process(COMMAND gzip -9 --no-name ${pages} COMMAND_ERROR_IS_FATAL ANY)

dem(${OUT}/dem completion bash)  # named as each shell looks for it
dem(${OUT}/_dem completion zsh)
dem(${OUT}/dem.fish completion fish)
