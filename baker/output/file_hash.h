#pragma once

#include <filesystem>
#include <string>

namespace paperbake {

/// The last line of summary.json holds the key of all text before it, so that the certificate tells
/// when it was changed itself.
std::string sealed(std::string summary_text);
bool seal_holds(const std::string& summary_text);

/// The key of a file's bytes: 32 hex digits. throws Error(ErrorCode::folder) when it cannot be read
std::string file_hash(const std::filesystem::path&);

/// The text of a file. throws Error(ErrorCode::folder) when it cannot be read
std::string read_output(const std::filesystem::path&);

}  // namespace paperbake
