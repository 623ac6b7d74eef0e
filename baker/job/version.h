#pragma once

namespace paperbake {

/// Version of the program, such as "1.2.3".
extern const char* const program_version;

}  // namespace paperbake
