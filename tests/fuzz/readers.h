#pragma once

#include <functional>
#include <map>
#include <string>

/// The readers of files from outside, each behind one call that accepts any bytes. The call returns
/// when the reader has returned or thrown a paperbake::Error with place and cause. Any other
/// exception leaves the call, and a crash ends the program.
namespace paperbake::fuzz {

using Reader = std::function<void(const std::string& bytes)>;

/// The readers by name:
///
/// scene        read_scene of a .glb file (by its magic number), a .gltf file (by its first brace)
///              or an .fbx file (all else)
/// import       only the importer, in this process, for an assimp built with sanitizers
/// imported     scene_of on a message of the importing process
/// gltf_curves  gltf_takes of a .glb file (by its magic number) or a .gltf file (all else)
/// fbx          import_fbx in this process, for ufbx built with sanitizers
/// preset       read_preset
/// lock         read_lock
/// job          load_job
/// certificate  verify of a folder with a "cache.abc"; the bytes are its handles.csv, frames.jsonl
///              and summary.json, separated by the byte 0x1E; the summary is sealed afterwards
/// cache        AlembicReader: the first sheets and the first frames of each
/// state        animate resumed from a state; the bytes are changes to a valid one, 13 bytes each
/// checkpoint   Checkpoints::load of a checkpoint that is changed likewise and then sealed
const std::map<std::string, Reader>& readers();

}  // namespace paperbake::fuzz
