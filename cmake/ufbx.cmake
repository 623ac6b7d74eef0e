# ufbx, the FBX reader (MIT): one C file, which is in no Debian package but in its author's crate of
# the same name. cargo brings that crate, and what it needs to be built as Rust, into the build
# folder; the C file is compiled from there. UFBX_FOLDER: where it is, or empty: why is said.

set(UFBX_CRATE 0.11.5)  # carries ufbx 0.23.1
set(UFBX_FOLDER "")
set(UFBX_CARGO ${CMAKE_BINARY_DIR}/ufbx)
set(UFBX_SOURCE ${UFBX_CARGO}/${UFBX_CRATE}/ufbx/ufbx)
string(CONCAT UFBX_COST "FBX files will be read through assimp: steps, tangents, layers and the "
  "start frame are lost")

if(NOT PAPERBAKE_UFBX)
  message(STATUS "PAPERBAKE_UFBX is off. ${UFBX_COST}")
  return()
endif()
if(NOT EXISTS ${UFBX_SOURCE}/ufbx.c)
  find_program(CARGO cargo PATHS $ENV{HOME}/.cargo/bin)
  if(NOT CARGO)
    message(WARNING
      "There is no cargo (Debian: apt install cargo), which brings ufbx. ${UFBX_COST}")
    return()
  endif()
  file(WRITE ${UFBX_CARGO}/Cargo.toml
    "[package]\nname = \"paperbake-ufbx\"\nversion = \"0.0.0\"\n"
    "[lib]\npath = \"none.rs\"\n[dependencies]\nufbx = \"=${UFBX_CRATE}\"\n[workspace]\n")
  file(WRITE ${UFBX_CARGO}/none.rs "")
  # cargo before 1.70, as in Debian 12, copies all of the registry's index first, unless it is made
  # to ask for single crates
  execute_process(COMMAND ${CARGO} --version OUTPUT_VARIABLE CARGO_VERSION ERROR_QUIET)
  string(REGEX MATCH "[0-9]+[.][0-9]+" CARGO_VERSION "${CARGO_VERSION}")
  set(SPARSE "")
  if(CARGO_VERSION VERSION_LESS 1.70)
    set(CARGO ${CMAKE_COMMAND} -E env RUSTC_BOOTSTRAP=1 ${CARGO})
    set(SPARSE -Z sparse-registry)
  endif()
  execute_process(COMMAND ${CARGO} ${SPARSE} vendor --quiet ${UFBX_CRATE}
    WORKING_DIRECTORY ${UFBX_CARGO} TIMEOUT 600
    RESULT_VARIABLE FAILED OUTPUT_QUIET ERROR_VARIABLE WHY)
  if(FAILED OR NOT EXISTS ${UFBX_SOURCE}/ufbx.c)
    string(STRIP "${WHY}" WHY)
    message(WARNING "cargo could not bring the crate ufbx ${UFBX_CRATE} (${FAILED}); run cmake "
      "again when there is a network. ${UFBX_COST}\n${WHY}")
    return()
  endif()
endif()
set(UFBX_FOLDER ${UFBX_SOURCE})
message(STATUS "FBX is read with ufbx: ${UFBX_SOURCE}")
