// Writes two caches and what foreign readers must find in them, for alembic_judge.py and
// blender_judge.py:
//
//   make_cache FOLDER    ->  constant.abc .usda .usdc .json    two sheets: one turning, one that
//   jumps once and rests
//                            constant.pc2 constant.rest.obj    the first of them
//                            varying.abc .usda .usdc .json     one sheet that is cut anew at some
//                            frames

#include "core/model/error.h"
#include "formats/cache/alembic_cache.h"
#include "formats/cache/pc2_cache.h"
#include "formats/cache/usd_cache.h"

#include <Eigen/Geometry>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>

using namespace paperbake;

namespace {

struct Sequence {
  std::string name, stored_name;
  std::vector<CacheFrame> frames;
};

/// A sheet of 0.21 x 0.297 m in columns x rows cells, rolled about an axis along y, so no two axes
/// look alike.
CacheFrame rolled(int columns, int rows, double radius) {
  CacheFrame frame;
  const int vertices = (columns + 1) * (rows + 1);
  frame.x.resize(vertices, 3);
  frame.normal.resize(vertices, 3);
  frame.uv.resize(vertices, 2);
  for (int i = 0; i < vertices; ++i) {
    const double u = double(i % (columns + 1)) / columns, v = double(i / (columns + 1)) / rows,
                 angle = 0.21 * u / radius;
    frame.x.row(i) << radius * std::sin(angle), 0.297 * v, radius * (1 - std::cos(angle));
    frame.normal.row(i) << -std::sin(angle), 0, std::cos(angle);
    frame.uv.row(i) << u, v;
  }
  frame.triangles.resize(2 * columns * rows, 3);
  for (int cell = 0; cell < columns * rows; ++cell) {
    const int a = cell % columns + cell / columns * (columns + 1), b = a + 1, c = a + columns + 1,
              d = c + 1;
    frame.triangles.row(2 * cell) << a, b, d;
    frame.triangles.row(2 * cell + 1) << a, d, c;
  }
  return frame;
}

/// The frame after `seconds` of turning at `rate` [rad/s, world axes] about the origin.
CacheFrame turned(CacheFrame frame, const Vector3d& rate, double seconds) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(rate.norm() * seconds, rate.normalized()).toRotationMatrix();
  frame.x *= turn.transpose();
  frame.normal *= turn.transpose();
  frame.velocity.resize(frame.x.rows(), 3);
  for (Eigen::Index i = 0; i < frame.x.rows(); ++i)
    frame.velocity.row(i) = rate.cross(Vector3d(frame.x.row(i))).transpose();
  return frame;
}

CacheFrame moved(CacheFrame frame, const Vector3d& by) {
  frame.x.rowwise() += by.transpose();
  return frame;
}

std::vector<Sequence> constant_topology(double fps) {
  Sequence turning{"paper", "paper", {}}, jumping{"strip.001", "strip_001", {}};
  for (int i = 0; i < 5; ++i) {
    turning.frames.push_back(turned(rolled(7, 5, 0.05), {0.3, -0.7, 2.1}, i / fps));
    const CacheFrame resting = turned(rolled(3, 9, 0.2), {1, 1, 1}, 0);
    jumping.frames.push_back(moved(resting, i < 2 ? Vector3d(0.5, 0, 0) : Vector3d(0.5, 0.25, 1)));
  }
  return {turning, jumping};
}

std::vector<Sequence> varying_topology(double fps) {
  Sequence cut{"cut", "cut", {}};
  const int columns[] = {3, 3, 5, 5, 3, 4};
  for (int i = 0; i < 6; ++i)
    cut.frames.push_back(
        turned(rolled(columns[i], columns[i] + 1, 0.08), {-0.4, 1.3, 0.2}, i / fps));
  return {cut};
}

template <class Rows>
void print_rows(std::ostream& out, const char* name, const Rows& rows) {
  const Eigen::IOFormat json(Eigen::FullPrecision, Eigen::DontAlignCols, ",", ",", "[", "]", "[",
                             "]");
  out << '"' << name << "\":" << rows.format(json);
}

void print_cut(std::ostream& out, const CacheFrame& frame) {
  print_rows(out, "triangles", frame.triangles);
  out << ',';
  print_rows(out, "uv", frame.uv);
  out << ',';
}

/// A sheet has the triangles and uv of its first frame; a frame that is cut otherwise has its own.
void print_sheet(std::ostream& out, const Sequence& sheet) {
  const CacheFrame& first = sheet.frames[0];
  out << "\n{\"name\":\"" << sheet.stored_name << "\",";
  print_cut(out, first);
  out << "\"frames\":[";
  for (const CacheFrame& frame : sheet.frames) {
    out << (&frame == &first ? "\n{" : ",\n{");
    if (frame.triangles.rows() != first.triangles.rows()) print_cut(out, frame);
    print_rows(out, "x", frame.x);
    out << ',';
    print_rows(out, "velocity", frame.velocity);
    out << ',';
    print_rows(out, "normal", frame.normal);
    out << '}';
  }
  out << "]}";
}

void print_expected(std::ostream& out, const CacheInfo& info, const std::vector<Sequence>& sheets) {
  out << "{\"fps\":" << info.fps << ",\"first_frame\":" << info.first_frame << ",\"metadata\":{";
  for (std::size_t i = 0; i < info.metadata.size(); ++i)
    out << (i ? "," : "") << '"' << info.metadata[i].first << "\":\"" << info.metadata[i].second
        << '"';
  out << "},\"sheets\":[";
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    out << (i ? "," : "");
    print_sheet(out, sheets[i]);
  }
  out << "]}\n";
}

void write_case(const std::filesystem::path& stem, const CacheInfo& info,
                const std::vector<Sequence>& sheets) {
  std::vector<std::string> names;
  for (const Sequence& sheet : sheets) names.push_back(sheet.name);
  AlembicWriter writer(stem.string() + ".abc", info, names);
  for (std::size_t f = 0; f < sheets[0].frames.size(); ++f)
    for (std::size_t i = 0; i < sheets.size(); ++i) writer.add_frame(i, sheets[i].frames[f]);
  writer.finish();
  for (const auto& [ending, encoding] :
       {std::pair(".usda", UsdEncoding::text), std::pair(".usdc", UsdEncoding::crate)}) {
    UsdWriter layer(stem.string() + ending, encoding, info, names);
    for (std::size_t f = 0; f < sheets[0].frames.size(); ++f)
      for (std::size_t i = 0; i < sheets.size(); ++i) layer.add_frame(i, sheets[i].frames[f]);
    layer.finish();
  }

  std::ofstream expected(stem.string() + ".json");
  expected.precision(17);
  print_expected(expected, info, sheets);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_cache FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  try {
    const CacheInfo constant{
        29.97, 1001, 1, {{"paperbake_job", "0123abcd"}, {"paperbake_version", "1.0"}}};
    const std::vector<Sequence> sheets = constant_topology(constant.fps);
    write_case(folder / "constant", constant, sheets);
    Pc2Writer points(folder / "constant.pc2", folder / "constant.rest.obj", constant);
    for (const CacheFrame& frame : sheets[0].frames) points.add_frame(frame, 0.297);
    points.finish();
    const CacheInfo varying{25, 101, 1, {{"paperbake_job", "4567cdef"}}};
    write_case(folder / "varying", varying, varying_topology(varying.fps));
  } catch (const Error& error) {
    std::cerr << "make_cache: " << error.what() << '\n';
    return int(error.code);
  }
}
