#pragma once

#include "core/model/authored_surface.h"
#include "core/model/sheet.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// Settings of a whole cache. No date, path or host name is written to the file.
struct CacheInfo {
  double fps = 24;
  int first_frame = 1;
  int frame_step = 1;  // frames from one sample to the next
  // additional archive metadata, such as job hash and version: key, value
  std::vector<std::pair<std::string, std::string>> metadata;
  std::string root = "/shot";  // path of identifiers: the prim of USD below which the sheets are
};

/// A number for each vertex of a frame.
struct CacheLayer {
  std::string name;        // an identifier
  Eigen::VectorXd values;  // |V|
};

/// Singular points and folds of a sheet at one frame, those born so far. They are for artists, who
/// draw, scatter or cut along them; they are not paper and are not rendered.
struct CacheGuides {
  Points3 points;                                   // [m] the singular points, in order of birth
  std::vector<int> point_id, point_birth;           // from 1, as in singular.csv; frame of birth
  Points3 folds;                                    // [m] polylines, one after another
  Eigen::VectorXd angle;                            // [rad] of each of these points, now; signed
  std::vector<int> fold_size, fold_id, fold_birth;  // of each polyline: points, number, frame
};

/// A coarser mesh of the same frame, for viewports.
struct CacheProxy {
  Points3 x;            // |V|x3 [m]
  Triangles triangles;  // |T|x3 counter-clockwise; may change from frame to frame
};

/// One frame of one mesh in world space: z up, metres, counter-clockwise faces. The Alembic writer
/// converts it to y up and clockwise faces. Vertices and triangles may change from frame to frame.
struct CacheFrame {
  Points3 x;         // |V|x3 [m]
  Points3 velocity;  // |V|x3 [m/s], or empty: none is written
  // |V|x3, or any number of rows when normal_of_corner is given; unit; may be empty
  Points3 normal;
  // |T|x3 index of the normal of each corner, or empty; stored once while it does not change
  Triangles normal_of_corner;
  // |V| [rad] how sharply the sheet is folded at the vertex, or empty: no colour is written
  Eigen::VectorXd crease;
  std::vector<CacheLayer> layers;  // further attributes; written to USD only
  Triangles triangles;             // |T|x3 counter-clockwise; stored once while it does not change
  // |V|x2 v up, or empty: where the vertices lie on the pattern, in shares of its longer side;
  // stored once while it does not change
  Points2 uv;
  // attributes and materials of the artist, or null; their number and names never change, and
  // frames with the same pointer have the same
  std::shared_ptr<const MeshSurface> surface;
  std::optional<CacheGuides> guides;  // all frames have them, or none
  std::optional<CacheProxy> proxy;    // the same; written to USD in separate layers only
};

/// Writes an Alembic (Ogawa) file with an Xform and a PolyMesh for each sheet, frame by frame. The
/// file is NAME.part until finish() gives it its name; without finish() the destructor deletes it.
///
/// The first uv set of the artist is `uv`, the others are named parameters. The pattern is a named
/// parameter `pattern`, and `uv` where the artist has none. Other attributes are parameters of the
/// corners: colours as C3f or C4f, numbers as float or V3f; two or four of them as lists of floats,
/// because a V2f would be taken for a uv set. Every material is a face set. Guides are Points
/// `NAME_points` and linear Curves `NAME_folds`, each below an Xform beside that of the sheet, with
/// the parameters `point_id` or `fold_id`, `birth` and, at the points of a curve, `angle`.
///
/// Sample i has the time (first_frame + i frame_step) / fps in seconds. Numbers are stored as
/// 32-bit floats. The same calls write the same bytes. A value that has been stored before, for
/// any sheet or frame, is referred to, not stored again; the writer keeps only position and key of
/// each sample in memory (under 1 kB per sheet and frame).
class AlembicWriter {
 public:
  /// sheet_names: unique. The Xform of a sheet gets its name, the mesh below that NAME + "Shape".
  /// Characters that other programs do not accept (dot, space, slash, colon, ...) become `_`; names
  /// that are equal after that get `_2`, `_3`, ... throws Error(ErrorCode::folder) when the file
  /// cannot be created
  AlembicWriter(const std::filesystem::path&, const CacheInfo&,
                const std::vector<std::string>& sheet_names);
  ~AlembicWriter();

  /// Appends the next frame of a sheet.
  /// sheet    index into sheet_names
  /// returns  content hash of the stored positions: 128 bits as 32 hex digits
  /// throws   Error(ErrorCode::simulation) when a value is not finite as a 32-bit float,
  ///          Error(ErrorCode::folder) when the disk is full. Either way nothing of the frame stays
  ///          in the file and finish() keeps the frames before it; after a full disk no frame may
  ///          be added.
  std::string add_frame(std::size_t sheet, const CacheFrame&);

  /// Writes the index, syncs the file and gives it its name; must be the last call. Sheets may have
  /// different numbers of frames; a sheet without frames is left out, and without any frame there
  /// is no file. When the disk has no room for the index, the last frames are dropped to make it.
  /// returns  number of frames of each sheet in the file
  /// throws   Error(ErrorCode::folder) when there is no room even for one frame
  std::vector<std::size_t> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace paperbake
