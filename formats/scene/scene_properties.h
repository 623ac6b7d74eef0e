#pragma once

#include "formats/scene/scene_import.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paperbake {

/// A list of numbers that FBX wrote as text, "[0.3, 0.03]"; else the text itself.
PropertyValue text_or_list(const std::string&);

/// Names as they are matched, not as they identify: lower case, `_` and `-` as `.`, no namespace in
/// front ("rig:"), no Blender number behind (".001"). "Rig:Handle_Left.001" -> "handle.left"
std::string matched_name(std::string_view raw);
bool name_begins_with(std::string_view raw, std::string_view prefix);

/// Exporters mark a bone's tail by a leaf: "arm_end" (FBX), "arm_leaf" (glTF).
bool is_tail_leaf(const std::string& name, const std::string& bone);

/// Where an error is, for its first line: shot.fbx, handle "corner"
std::string place_of(const std::string& source, std::string_view kind, std::string_view name);

/// Custom properties, tolerant of the type a DCC and a format made of them: 24, 24.0 and "24" are
/// one number. none when the node has no such property or its text is empty. `source` is the file's
/// name for messages. throws Error(Fault::scene) that names file, node and key: the value cannot be
/// read as what is asked for.
std::optional<double> number_property(const std::string& source, const ImportedNode&,
                                      const std::string& key);
std::optional<int> whole_property(const std::string& source, const ImportedNode&,
                                  const std::string& key);
// > 0
std::optional<double> positive_property(const std::string& source, const ImportedNode&,
                                        const std::string& key);
// >= 0
std::optional<double> nonnegative_property(const std::string& source, const ImportedNode&,
                                           const std::string& key);
std::optional<std::string> text_property(const ImportedNode&, const std::string& key);
// empty when it is no list
std::vector<double> list_property(const ImportedNode&, const std::string& key);
// false when there is none
bool flag_property(const ImportedNode&, const std::string& key);

/// One sentence for each paper_* property that has no meaning here.
std::vector<std::string> unknown_properties(const std::vector<ImportedNode>&);

}  // namespace paperbake
