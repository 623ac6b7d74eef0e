#pragma once

namespace paperbake {

/// Version of the program, such as "1.2.3".
extern const char* const program_version;
/// Versions of the libraries that it was built with, separated by commas.
extern const char* const program_libraries;
/// Commit of the source, with "+changes" when it had changes; "unknown" outside a repository. Part
/// of the executable, not of the library.
extern const char* const program_commit;

}  // namespace paperbake
