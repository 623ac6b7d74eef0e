// libFuzzer over one of the readers; READER is its name.

#include "tests/fuzz/readers.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const paperbake::fuzz::Reader& read = paperbake::fuzz::readers().at(READER);
  read(std::string(reinterpret_cast<const char*>(bytes), size));
  return 0;
}
