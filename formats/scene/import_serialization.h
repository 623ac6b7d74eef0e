#pragma once

#include "formats/scene/scene_import.h"

#include <string>
#include <string_view>

namespace paperbake {

/// The outcome of importing a scene file, as it is sent from the importing process to its parent.
struct ImportResult {
  ImportedFile file;
  std::string place, cause, remedy;  // of the error; without an error cause is empty
};

std::string serialize(ImportResult);

/// Reads what serialize() wrote. Nothing in the bytes is trusted, because the importing process has
/// run third-party code on an unchecked file.
/// throws Error(ErrorCode::scene) when the bytes are not an ImportResult; Damage when they violate
/// what import_file promises of an ImportedFile
ImportResult deserialize(std::string_view bytes);

}  // namespace paperbake
