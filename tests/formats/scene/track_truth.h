#pragma once

#include "formats/scene/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace paperbake::test {

/// Positions [m] that a DCC evaluated, by node and frame, from rows "frame,node,x,y,z".
inline std::map<std::string, std::map<int, Vector3d>> truth(const std::filesystem::path& csv) {
  std::map<std::string, std::map<int, Vector3d>> rows;
  std::ifstream file(csv);
  for (std::string line; std::getline(file, line);) {
    if (line.rfind('#', 0) == 0 || line.rfind("frame", 0) == 0) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    int frame;
    std::string node;
    Vector3d p;
    words >> frame >> node >> p.x() >> p.y() >> p.z();
    rows[node][frame] = p;
  }
  return rows;
}

struct TrackError {
  double worst = 0;   // [m] largest error
  double motion = 0;  // [m] largest distance of a node from its first position
  int compared = 0;   // number of positions
};

/// Compares the tracks of a file with what a DCC evaluated. A missing position fails the test.
inline TrackError track_error(const Tracks& tracks, const std::filesystem::path& csv) {
  TrackError error;
  for (const auto& [node, rows] : truth(csv)) {
    const auto at = std::find(tracks.names.begin(), tracks.names.end(), node);
    if (at == tracks.names.end()) {
      ADD_FAILURE() << "no track of " << node;
      continue;
    }
    const Points3& track = tracks.positions[at - tracks.names.begin()];
    for (const auto& [frame, p] : rows) {
      const int row = frame - tracks.first_frame;
      if (row < 0 || row >= track.rows()) {
        ADD_FAILURE() << node << " has no frame " << frame;
        continue;
      }
      error.worst = std::max(error.worst, (track.row(row).transpose() - p).norm());
      error.motion = std::max(error.motion, (p - rows.begin()->second).norm());
      ++error.compared;
    }
  }
  return error;
}

}  // namespace paperbake::test
