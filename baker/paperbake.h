#pragma once

#include "core/model/error.h"
#include "core/model/frame.h"
#include "formats/scene/scene_file.h"

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// The library in one header: a scene goes in, frames or an output folder come out.
///
///   Scene scene = read_scene("shot.glb");           // or made in code, with flat_sheet()
///   simulate_scene(scene, {{"method", "fem"}}, on_frame);
///   bake_scene(scene, "out", {{"quality", "draft"}});
///
/// Units are SI: metres, seconds, newtons, joules. The world is right-handed with z up; u and v are
/// the axes of the flat pattern. A matrix of points has one row for each point.
///
/// Errors: every function throws Error (core/model/error.h), which has place, cause and remedy.
/// Nothing is printed. Arguments are copied: they need not outlive a call. Functions may run in
/// several threads at once, but not two bakes into one folder.

namespace paperbake {

/// A rectangle of paper at rest in the plane z = 0, with its front upwards: the point (u, v) of the
/// pattern lies at (u, v, 0). Add handles to it, and the sheet to Scene::sheets.
/// width, height  [m] along u and v
SceneSheet flat_sheet(std::string name, double width, double height);

/// What is done with a scene, in the words of a job file (docs/job_files.md). What is left out has
/// the default of the command line.
struct BakeJob {
  // options of the bake by name: {"method", "fem"}, {"gravity", "9.81"}, {"frames", "1-48"}
  std::map<std::string, std::string> options;
  // numbers of the paper over those of its grade, for all sheets: {"thickness", 90e-6} [SI]
  std::map<std::string, double> paper;

  BakeJob() = default;
  BakeJob(std::initializer_list<std::pair<const std::string, std::string>> options)
      : options(options) {}
};

/// Simulates the sheets of a scene and writes nothing. Options of the output have no effect, nor
/// have `attempts`, `twin`, `resume` and `checkpoint`: the first attempt at the shot is
/// handed out as it is simulated, and where bake_scene() bakes another one, its frames differ.
///
/// on_frame  called on this thread for every frame in order, and within a frame for every sheet in
///           order; with the option polish: for all frames of a sheet, then for those of the next.
///           frame.sheet_index is the index into scene.sheets. The frame and its sheet are valid
///           until on_frame returns: copy what is to be kept. Return false to cancel:
///           simulate_scene() then returns, and nothing is thrown.
/// throws    Error(ErrorCode::scene): a sheet or a handle that cannot be;
///           Error(ErrorCode::command): unknown option or paper grade, or a value out of range;
///           Error(ErrorCode::simulation): a sheet cannot follow its handles into the first frame
void simulate_scene(const Scene&, const BakeJob&,
                    const std::function<bool(const AnimatedFrame&)>& on_frame);

/// A frame that is done.
struct BakeProgress {
  std::string pass;  // "simulated"; in a second pass over all frames "rendered"
  std::string sheet;
  int frame = 0;
  int done = 0, frames = 0;  // of all sheets: frames that this pass has done, and has to do
};

/// What is told and asked while a scene is baked. Any of these may be empty. They are called one at
/// a time, but not always on the thread that called bake_scene(), and must not throw.
struct BakeCallbacks {
  std::function<void(const BakeProgress&)> on_progress;
  std::function<void(const std::string& sentence)> on_message;  // warnings and the like
  // asked after every frame of both passes; true: stop. Frames that are not rendered half a second
  // later are left out of the files
  std::function<bool()> cancel;
};

/// What a bake wrote.
struct BakeResult {
  std::vector<std::filesystem::path> files;  // in the order in which people look for them
  // one sentence for every quality gate that was missed (docs/output_files.md)
  std::vector<std::string> missed_gates;
};

/// Bakes a scene into a folder, as the program does (docs/output_files.md): cache, maps,
/// certificate, report. The names of the files begin with the stem of scene.source, or with "scene"
/// when that is empty. What an earlier bake left in the folder is not simulated again as far as
/// nothing has changed.
/// throws  what simulate_scene() throws; Error(ErrorCode::folder): folder busy or not writable;
///         Error(ErrorCode::stopped): cancelled. Frames until then are kept, and the same call goes
///         on from there.
BakeResult bake_scene(const Scene&, const std::filesystem::path& folder, const BakeJob& = {},
                      const BakeCallbacks& = {});

}  // namespace paperbake
