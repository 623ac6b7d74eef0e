// The libFuzzer target of one of the readers, whose name is READER. To be built with clang
// (packages.txt, [fuzz]):
//
//   cmake --preset fuzz && cmake --build --preset fuzz
//   build-fuzz/fuzz_scene -max_total_time=600 -timeout=10 -malloc_limit_mb=1024
//     -dict=tests/fuzz/scene.dict FOLDER tests/fuzz/corpus/scene
//
// Findings are minimized (-minimize_crash=1) and added to tests/fuzz/corpus. fuzz_import is more
// informative with an assimp that is built with the same sanitizers (-DCMAKE_PREFIX_PATH=...). In
// the program itself a crash of the importer ends only the sandboxed process in which it runs.

#include "tests/fuzz/readers.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const paperbake::fuzz::Reader& read = paperbake::fuzz::readers().at(READER);
  read(std::string(reinterpret_cast<const char*>(bytes), size));
  return 0;
}
