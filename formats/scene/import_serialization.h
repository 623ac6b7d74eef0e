#pragma once

#include "formats/scene/scene_import.h"

#include <string>
#include <string_view>

namespace paperbake {

/// What comes of reading a scene file, from one process to another.
struct ImportResult {
  ImportedFile file;
  std::string place, cause, remedy;  // of an error; no cause: there was none
};

std::string serialize(ImportResult);

/// The message again. Nothing in the bytes is trusted: they come from where foreign code has been
/// at work. throws std::runtime_error when they are no message or break what ImportedFile promises
ImportResult deserialize(std::string_view bytes);

}  // namespace paperbake
