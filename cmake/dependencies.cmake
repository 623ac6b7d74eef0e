# The packages that paperbake is built on.

find_package(Eigen3 REQUIRED NO_MODULE)
find_package(CHOLMOD REQUIRED)
find_package(CGAL REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
pkg_check_modules(OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)
pkg_check_modules(LIBPNG REQUIRED IMPORTED_TARGET libpng)
pkg_check_modules(LIBDEFLATE REQUIRED IMPORTED_TARGET libdeflate)

pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)
if(PAPERBAKE_FUZZ)
  # Its headers alone: a parser that is compiled in shows its branches to the fuzzer.
  # Assertions and optimiser hints stay as Debian packages them.
  set_target_properties(PkgConfig::TOMLPLUSPLUS PROPERTIES
    INTERFACE_COMPILE_OPTIONS "-DTOML_ASSERT(e)=static_assert(true);-fno-sanitize=unreachable"
    INTERFACE_LINK_LIBRARIES "")
endif()

include(ufbx)
if(UFBX_FOLDER)
  add_library(ufbx OBJECT ${UFBX_FOLDER}/ufbx.c)  # becomes a part of the library "formats"
  target_include_directories(ufbx SYSTEM PUBLIC ${UFBX_FOLDER})
  target_compile_options(ufbx PRIVATE -w)
  paperbake_not_hot(ufbx)
else()
  find_package(assimp REQUIRED)
endif()

# Goes into report.html
find_path(JAVASCRIPT three/three.min.js PATHS /usr/share/javascript REQUIRED)
