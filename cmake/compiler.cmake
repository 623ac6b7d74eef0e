# How everything is compiled: the target paperbake_options, which every library links privately.

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_FLAGS_RELEASE "-O3")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

add_library(paperbake_options INTERFACE)
target_compile_options(paperbake_options INTERFACE
  -Wall -Wextra -fno-math-errno -fpch-preprocess
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)  # GCC 12 reports an overflow in fmt 9 that is none
if(PAPERBAKE_CPU AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(paperbake_options INTERFACE -march=${PAPERBAKE_CPU})
endif()
if(DEFINED ENV{CI})
  target_compile_options(paperbake_options INTERFACE -Werror)
endif()
if(PAPERBAKE_SANITIZE)
  target_compile_options(paperbake_options INTERFACE
    -fsanitize=${PAPERBAKE_SANITIZE} -fno-sanitize-recover=all -g)
  target_link_options(paperbake_options INTERFACE -fsanitize=${PAPERBAKE_SANITIZE})
endif()
if(PAPERBAKE_FUZZ)  # branches are counted everywhere; a main is linked into the fuzzers only
  target_compile_options(paperbake_options INTERFACE
    -fsanitize=fuzzer-no-link
    -fno-sanitize=pointer-overflow)  # Eigen adds offsets to the null pointer of an empty matrix
endif()
target_include_directories(paperbake_options INTERFACE ${PROJECT_SOURCE_DIR})
