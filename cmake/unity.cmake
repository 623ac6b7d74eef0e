# PAPERBAKE_UNITY: compile the files of a room together, as one translation unit. A first build
# then takes half the CPU time, because templates are instantiated once a room; a developer, who
# changes one file at a time, is better off without.

option(PAPERBAKE_UNITY "Compile the files of each room together: a faster first build" OFF)

# paperbake_unity(TARGET [APART FILE...] [TOGETHER ROOM...]): the files after APART are compiled by
# themselves, because names of theirs, or of the packages they include, would clash; the rooms after
# TOGETHER are one translation unit
function(paperbake_unity target)
  cmake_parse_arguments(PARSE_ARGV 1 UNITY "" "" "APART;TOGETHER")
  if(NOT PAPERBAKE_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # GCC takes the sources that a unit includes for headers, whose classes must have no members of
  # types of an anonymous namespace. A build without PAPERBAKE_UNITY still warns of real headers.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "^[a-z0-9_]+/.*[.]cpp$")
  list(REMOVE_ITEM sources ${UNITY_APART})
  foreach(source IN LISTS sources)
    string(REGEX MATCH "^[a-z0-9_]+" room ${source})
    if(room IN_LIST UNITY_TOGETHER)
      list(JOIN UNITY_TOGETHER "_" room)
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room})
  endforeach()
endfunction()
