#include "baker/job/version.h"

namespace paperbake {

const char* const program_version = PAPERBAKE_VERSION;
const char* const program_libraries = PAPERBAKE_LIBRARIES;

}  // namespace paperbake
