# Packages that need no compiler (docs/packages.md), made in the folder "dist" of the build:
#
#   package_deb    paperbake_VERSION_amd64.deb                 with Debian's own libraries
#   blender_addon  paperbake_blender-VERSION-linux-x64.zip     with the program and its libraries
#   wheel          paperbake-VERSION-py3-none-manylinux_*.whl  with the program and its libraries
#
# All hold the program of this build as it is. Those for other machines come from a build for the
# baseline (cmake --preset package); the version of any other names the processor it is for.

set(DIST ${CMAKE_BINARY_DIR}/dist)
set(PACKAGE_VERSION ${PROJECT_VERSION})
if(PAPERBAKE_CPU AND NOT PAPERBAKE_CPU MATCHES "^x86-64(-v2)?$")
  string(REGEX REPLACE "[-_]" "." CPU_SUFFIX ${PAPERBAKE_CPU})
  string(APPEND PACKAGE_VERSION "+${CPU_SUFFIX}")
endif()

# Debian packages whose source is compiled into the program: their terms go into every package.
# ufbx is in the public domain (Unlicense) and asks for none.
set(COMPILED_IN libeigen3-dev libcgal-dev libboost-dev libcli11-dev nlohmann-json3-dev
  libjs-three libjs-chart.js)

# ---- the program with its libraries --------------------------------------------------------------
set(BUNDLE ${CMAKE_BINARY_DIR}/bundle)
set(PACKING ${PROJECT_SOURCE_DIR}/cmake)
add_custom_command(OUTPUT ${BUNDLE}/libraries.txt
  COMMAND python3 -B ${PACKING}/bundle.py
    $<TARGET_FILE:paperbake> ${BUNDLE} ${PROJECT_SOURCE_DIR}/LICENSE ${COMPILED_IN}
  DEPENDS paperbake ${PACKING}/bundle.py VERBATIM)
add_custom_target(bundle DEPENDS ${BUNDLE}/libraries.txt)

add_custom_target(blender_addon
  COMMAND python3 -B ${PROJECT_SOURCE_DIR}/baker/blender/make_zip.py
    ${DIST} ${BUNDLE} ${PACKAGE_VERSION}
  DEPENDS bundle VERBATIM)
add_custom_target(wheel
  COMMAND python3 -B ${PROJECT_SOURCE_DIR}/baker/python/make_wheel.py
    ${DIST} ${BUNDLE} ${PACKAGE_VERSION}
  DEPENDS bundle VERBATIM)

# ---- the package for Debian ----------------------------------------------------------------------
install(TARGETS paperbake RUNTIME DESTINATION bin COMPONENT program)
set(DOCUMENTATION share/doc/paperbake)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${DOCUMENTATION} RENAME copyright
  COMPONENT program)
foreach(package IN LISTS COMPILED_IN)
  install(FILES /usr/share/doc/${package}/copyright DESTINATION ${DOCUMENTATION}/licenses
    RENAME ${package} COMPONENT program OPTIONAL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME paperbake)
set(CPACK_PACKAGE_VERSION ${PACKAGE_VERSION})
set(CPACK_PACKAGE_VENDOR "The authors of paperbake")
set(CPACK_PACKAGE_CONTACT "The authors of paperbake")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Bakes paper animation from keyed handles")
set(CPACK_PACKAGE_DESCRIPTION
  "An FBX or glTF scene with a flat sheet and animated handles goes in; an Alembic
cache (or USD), crease maps and a certificate of how good every frame is come out.")
set(CPACK_PACKAGE_DIRECTORY ${DIST})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 1)               # xz of several threads gives other bytes
set(CPACK_COMPONENTS_ALL program)  # of all that is installed
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME paperbake)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION ${CPACK_PACKAGE_DESCRIPTION})
set(CPACK_DEBIAN_PROGRAM_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# CHOLMOD is content with any BLAS; this one is fast and safe for several threads, and the one that
# the other packages bring
set(CPACK_DEBIAN_PACKAGE_DEPENDS libopenblas0-pthread)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PROJECT_CONFIG_FILE ${PACKING}/packing_time.cmake)
include(CPack)
add_custom_target(package_deb
  COMMAND ${CMAKE_CPACK_COMMAND} -G DEB
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${DIST}/_CPack_Packages
  DEPENDS paperbake VERBATIM)

include(${PROJECT_SOURCE_DIR}/tests/packaging/tests.cmake)
