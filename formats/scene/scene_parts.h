#pragma once

namespace paperbake {

/// Which files a scene file may name as parts of it: those of its own folder and below it, wherever
/// links lead, or any.
enum class Parts { of_its_folder, anywhere };

}  // namespace paperbake
