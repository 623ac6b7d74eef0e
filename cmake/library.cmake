# The libraries for other projects: paperbake::core, paperbake::formats and paperbake::bake, through
# find_package(paperbake) after cmake --install, or through add_subdirectory (docs/library.md).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(PAPERBAKE_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/paperbake)

# Headers lie under include/paperbake, as #include <paperbake/core/model/sheet.h> and, among
# themselves, "core/model/sheet.h". Links make it so in the build folder too.
set(PAPERBAKE_HEADERS ${PROJECT_BINARY_DIR}/include/paperbake)
file(CONFIGURE OUTPUT ${PAPERBAKE_HEADERS}/paperbake.h CONTENT
  "#pragma once\n\n#include \"baker/paperbake.h\"  // IWYU pragma: export\n")
foreach(folder core formats baker)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PAPERBAKE_HEADERS}/${folder} SYMBOLIC)
endforeach()

# paperbake_library(TARGET NAME [HEADER...]): other projects know the target as paperbake::NAME. The
# headers are kept from them, because they include libraries that only this build needs.
function(paperbake_library target name)
  add_library(paperbake::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} OUTPUT_NAME paperbake_${name})
  paperbake_elementary_functions(${target})
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/paperbake>)
  if(PAPERBAKE_INSTALL)
    install(TARGETS ${target} EXPORT paperbakeTargets
      ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
    foreach(header blender python ${ARGN})
      list(APPEND excluded PATTERN ${header} EXCLUDE)
    endforeach()
    install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} COMPONENT library
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/paperbake FILES_MATCHING PATTERN "*.h" ${excluded})
  endif()
endfunction()

if(PAPERBAKE_INSTALL)
  install(FILES ${PAPERBAKE_HEADERS}/paperbake.h COMPONENT library
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/paperbake)
  install(EXPORT paperbakeTargets NAMESPACE paperbake:: COMPONENT library
    DESTINATION ${PAPERBAKE_PACKAGE})
  set(PAPERBAKE_USES_ASSIMP ON)
  if(TARGET ufbx)
    set(PAPERBAKE_USES_ASSIMP OFF)
  endif()
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/paperbakeConfig.cmake.in
    ${PROJECT_BINARY_DIR}/paperbakeConfig.cmake INSTALL_DESTINATION ${PAPERBAKE_PACKAGE}
    NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/paperbakeConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/paperbakeConfig.cmake
    ${PROJECT_BINARY_DIR}/paperbakeConfigVersion.cmake ${PROJECT_SOURCE_DIR}/cmake/FindCHOLMOD.cmake
    DESTINATION ${PAPERBAKE_PACKAGE} COMPONENT library)
endif()
