#pragma once

#include <string>

namespace paperbake {

/// Writes a text to standard error. When it is closed, or its reader is gone, or its disk is full,
/// the text is lost and nothing else happens.
void say(const std::string& text);

/// The same with the end of the line.
void say_line(const std::string& sentence);

/// Writes what a command was called for to standard output; nothing when its reader has gone.
/// throws  Error(ErrorCode::folder) when it cannot be written
void print_data(const std::string& text);

/// A line on standard output, for lists that are of use but are not what the command was called
/// for. Lost where it cannot be written.
void list_line(const std::string& line);

}  // namespace paperbake
