# Copies the SOURCES below FROM to the same places below TO.
foreach(source IN LISTS SOURCES)
  get_filename_component(folder ${TO}/${source} DIRECTORY)
  file(COPY ${FROM}/${source} DESTINATION ${folder})
endforeach()
