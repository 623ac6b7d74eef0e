#pragma once

#include "formats/scene/scene_import.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paperbake {

/// The numbers of a list that FBX stores as text, "[0.3, 0.03]"; else the text itself.
PropertyValue text_or_list(const std::string&);

/// The form of a name that prefixes and patterns are compared with: lower case, `.` for `_` and
/// `-`, without namespace ("rig:") and Blender's number (".001"): "Rig:Handle_Left.001" becomes
/// "handle.left". What is before a colon is no namespace if the whole name begins as the names of
/// sheets, handles, colliders, creases or winds do and what is behind the colon does not: "Paper:
/// Letter". A node is identified by its full name.
std::string matched_name(std::string_view raw);
bool name_begins_with(std::string_view raw, std::string_view prefix);
/// Whether it begins so and goes on as a word, such as "Paperclip" with "paper".
bool is_longer_word(std::string_view raw, std::string_view prefix);

/// Whether `name` is that of the leaf node by which exporters mark the tail of a bone: "arm_end"
/// (FBX) or "arm_leaf" (glTF) for "arm".
bool is_tail_leaf(const std::string& name, const std::string& bone);

/// The name of the object of which a node is a copy in the instance of a collection, "paper" for
/// "table|paper|Dupli|" in an FBX of Blender; empty for any other node.
std::string instanced_name(std::string_view name);
/// The remedy for a sheet, handle or collider that is such a copy.
inline const char* const realise_instances =
    "Make the instances real before the export (in Blender: Object > Apply > Make Instances Real), "
    "and see that the objects have names of their own.";

/// A warning for each node that would be a sheet, handle, collider, crease or wind if it were not
/// the copy of one in the instance of a collection.
std::vector<std::string> ignored_instances(const std::vector<ImportedNode>&);

/// A warning for each node that has no part in the scene, but a name that begins nearly as those do
/// that have one.
std::vector<std::string> misspelt_names(const std::vector<ImportedNode>&);

/// The place of an error: shot.fbx, handle "corner".
std::string place_of(const std::string& source, std::string_view kind, std::string_view name);

/// The value of a custom property; nothing when the node has no such property or its text is empty.
/// DCCs and formats store the same value in different types: 24, 24.0 and "24" are one number.
/// source  file name for error messages
/// wanted  what the value should be, for the error message
/// throws  Error(ErrorCode::scene) with file, node and key when the value does not have the type or
///         range that is asked for
std::optional<double> number_property(const std::string& source, const ImportedNode&,
                                      const std::string& key, const char* wanted = "a number");
std::optional<int> whole_property(const std::string& source, const ImportedNode&,
                                  const std::string& key);
// > 0
std::optional<double> positive_property(const std::string& source, const ImportedNode&,
                                        const std::string& key);
// >= 0
std::optional<double> nonnegative_property(const std::string& source, const ImportedNode&,
                                           const std::string& key);
std::optional<std::string> text_property(const ImportedNode&, const std::string& key);
// empty when there is none or it is not a list
std::vector<double> list_property(const ImportedNode&, const std::string& key);
// nothing when there is none, or it says neither yes nor no
std::optional<bool> yes_or_no(const ImportedNode&, const std::string& key);
// whether it says yes
bool flag_property(const ImportedNode&, const std::string& key);

/// A number that any object may give for the whole scene, and the name of the first that gives it;
/// nothing when none does.
/// read    reads it: number_property or positive_property
/// throws  Error(ErrorCode::scene) as these do, and when two objects give different numbers
struct NumberOfScene {
  double value;
  std::string node;
};
std::optional<NumberOfScene> number_of_scene(
    const std::string& source, const std::vector<ImportedNode>&, const std::string& key,
    const std::function<std::optional<double>(const ImportedNode&)>& read);

/// A warning for each paper_* property that is not known.
std::vector<std::string> unknown_properties(const std::vector<ImportedNode>&);

}  // namespace paperbake
