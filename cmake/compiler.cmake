# How everything here is compiled. The options are those of this folder and the folders in it: a
# project that links the libraries, installed or by add_subdirectory, gets none of them.

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

add_compile_options(
  -Wall -Wextra -fno-math-errno -fpch-preprocess
  # GCC 12 reports an overflow in fmt 9 that is none
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
if(PAPERBAKE_CPU AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-march=${PAPERBAKE_CPU})
endif()

# paperbake_not_hot(TARGET): -O1, which compiles in two thirds of the time, for tests and for code
# in which a bake spends next to none of its time
function(paperbake_not_hot target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# The libraries may become part of a shared library. A function keeps being inlined into its
# neighbours although a shared library could replace it: the same instructions compute the same
# bytes as without.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
add_compile_options(-fno-semantic-interposition)

# Assertions name their files from the root of the project, wherever that lies
add_compile_options(-fmacro-prefix-map=${PROJECT_SOURCE_DIR}/= -fmacro-prefix-map=../=)

# Warnings are errors where it is asked for: cmake -DPAPERBAKE_WERROR=ON
option(PAPERBAKE_WERROR "Treat warnings as errors" OFF)
if(PAPERBAKE_WERROR)
  add_compile_options(-Werror)
endif()
if(PAPERBAKE_SANITIZE)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
  add_compile_options(-fsanitize=${PAPERBAKE_SANITIZE} -fno-sanitize-recover=all -g)
  add_link_options(-fsanitize=${PAPERBAKE_SANITIZE})
endif()
if(PAPERBAKE_FUZZ)  # branches are counted everywhere; a main is linked into the fuzzers only
  add_compile_options(
    -fsanitize=fuzzer-no-link
    -fno-sanitize=pointer-overflow)  # Eigen adds offsets to the null pointer of an empty matrix
endif()
