#pragma once

#include <functional>
#include <map>
#include <string>

/// The readers of files that come from elsewhere, each behind one call that takes any bytes. It
/// returns when the reader did, or when it threw paperbake::Error with place and cause. Anything
/// else leaves the call, or ends the program.
namespace paperbake::fuzz {

using Reader = std::function<void(const std::string& bytes)>;

/// scene        read_scene of a .glb (magic), .gltf (brace) or .fbx file
/// import       the same up to the importer, in this process: for assimp with sanitizers
/// imported     scene_of a message of the importing process
/// gltf_curves  read_gltf_curves of a .glb (magic) or .gltf file
/// fbx          import_fbx, in this process: ufbx with sanitizers
/// preset, lock, job
/// certificate  verify of a folder whose handles.csv, frames.jsonl and summary.json are parted by
///              byte 0x1E; the summary is sealed, and "cache.abc" is there
/// cache        AlembicReader: every sheet, the first frames of each
/// state        animate that goes on from a state; the bytes say what to change in a sound one, 13
///              for each place
/// checkpoint   Checkpoints::take of a checkpoint changed likewise, and sealed
const std::map<std::string, Reader>& readers();

}  // namespace paperbake::fuzz
