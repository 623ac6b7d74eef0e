#pragma once

#include <string>

namespace paperbake {

/// The text that printf would print.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace paperbake
