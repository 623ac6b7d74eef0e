#pragma once

#include <filesystem>
#include <string>

namespace paperbake {

/// One page that shows two bakes side by side: their report.html in two frames that show the same
/// frame of the shot, above them what differs in their certificates and settings. It needs nothing
/// else, as a report does.
/// a, b    output folders of bakes
/// throws  Error(ErrorCode::command) when one of them has no report.html or no certificate
std::string comparison_page(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace paperbake
