#include "baker/job/version.h"

namespace paperbake {

const char* const program_version = PAPERBAKE_VERSION;

}  // namespace paperbake
