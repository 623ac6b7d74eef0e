#pragma once

#include "core/model/sheet.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// Settings of a whole cache. Nothing with a date, a path or a host name goes into the file.
struct CacheInfo {
  double fps = 24;
  int first_frame = 1;
  int frame_step = 1;  // frames from one sample to the next
  // extra archive metadata: key, value (job hash, version)
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// A number for each vertex.
struct CacheLayer {
  std::string name;        // an identifier
  Eigen::VectorXd values;  // |V|
};

/// One frame of one mesh, in world space: z up, metres. Turned into y up and clockwise faces by the
/// writer. The number of vertices and the triangles may change from frame to frame.
struct CacheFrame {
  Points3 x;         // |V|x3 [m]
  Points3 velocity;  // |V|x3 [m/s]  may be empty: then none is written
  // |V|x3        unit, per vertex; with normal_of_corner any number of them; may be empty
  Points3 normal;
  // |T|x3  which normal each corner has; may be empty; stored once while it does not change
  Triangles normal_of_corner;
  // |V| [rad] how sharply the sheet is folded there; may be empty: then no colour is written
  Eigen::VectorXd crease;
  std::vector<CacheLayer> layers;  // more that the sheet shows; only USD layers have them
  Triangles triangles;  // |T|x3        counter-clockwise; stored once while it does not change
  // |V|x2        per vertex, v up; may be empty; stored once while it does not change
  Points2 uv;
};

/// Writes an Alembic (Ogawa) file with one Xform + PolyMesh for each sheet, frame by frame. The
/// file gets its name when finish() is called; before that it is NAME.part, and it is removed when
/// the writer goes without finish().
///
/// Sample i is at (first_frame + i) / fps seconds. Numbers are stored as 32-bit floats. The same
/// calls write the same bytes. Values that were stored before, of whatever sheet and frame, are not
/// stored again; only where each sample lies and its key stay in memory (under 1 kB per sheet and
/// frame).
class AlembicWriter {
 public:
  /// sheet_names: unique; a name is that of the Xform, the mesh under it is called NAME + "Shape".
  /// Characters that hosts refuse (dot, space, slash, colon, ...) become `_`; names that are the
  /// same after that get `_2`, `_3`, ... throws Error(Fault::folder) when the file cannot be made.
  AlembicWriter(const std::filesystem::path&, const CacheInfo&,
                const std::vector<std::string>& sheet_names);
  ~AlembicWriter();

  /// Appends the next frame of sheet `sheet` (index into sheet_names). throws
  /// Error(Fault::simulation) when a value is not finite as a float: the frame leaves no trace
  /// then, and finish() may still keep those before it; Error(Fault::folder) when the disk is full:
  /// the same, and no frame may follow. returns the 128-bit content key of the stored positions, 32
  /// hex digits.
  std::string add_frame(std::size_t sheet, const CacheFrame&);

  /// Writes the rest, syncs, and gives the file its name; the last call. A sheet may have fewer
  /// frames than another, and without any it is left out; without any frame there is no file. Where
  /// there is no room for the rest, the last frames give up theirs. returns how many frames of each
  /// sheet the file has throws Error(Fault::folder) when there is no room for even one
  std::vector<std::size_t> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace paperbake
