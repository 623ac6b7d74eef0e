// libFuzzer over one of the readers; READER is its name. With clang (packages.txt, [fuzz]):
//
//   cmake --preset fuzz && cmake --build --preset fuzz
//   build-fuzz/fuzz_scene -max_total_time=600 -timeout=10 -malloc_limit_mb=1024
//   -dict=tests/fuzz/scene.dict FOLDER tests/fuzz/corpus/scene
//
// What it finds goes, made small (-minimize_crash=1), into tests/fuzz/corpus. fuzz_import tells
// more of an assimp that is built with the same sanitizers, which -DCMAKE_PREFIX_PATH names; its
// findings end a process of their own in the tool.

#include "tests/fuzz/readers.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const paperbake::fuzz::Reader& read = paperbake::fuzz::readers().at(READER);
  read(std::string(reinterpret_cast<const char*>(bytes), size));
  return 0;
}
