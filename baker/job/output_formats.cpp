#include "baker/job/output_formats.h"

#include <algorithm>

namespace paperbake {

const std::vector<OutputFormat>& output_formats() {
  static const std::vector<OutputFormat> formats{
      {"abc", "NAME.abc", "Alembic cache of all sheets", true, true, false},
      {"maps", "maps/NAME.####.exr", "crease and apex maps", true, false, false},
      {"cert", "cert/frames.jsonl", "certificate of every frame", true, false, false},
      {"report", "report.html", "page with animation, curves and maps", true, true, false},
      {"usd", "NAME.usda", "USD layer of all sheets", false, true, false},
      {"usdc", "NAME.usdc", "the same in binary form", false, true, false},
      {"pc2", "NAME.pc2", "point cache of each sheet with its NAME.rest.obj", false, true, true},
      {"preview", "NAME.preview.png", "picture of up to 16 frames", false, true, false},
  };
  return formats;
}

std::set<std::string> default_formats() {
  std::set<std::string> names;
  for (const OutputFormat& format : output_formats())
    if (format.is_default) names.insert(format.name);
  return names;
}

bool has_frames(const std::set<std::string>& formats) {
  return std::any_of(output_formats().begin(), output_formats().end(),
                     [&](const OutputFormat& f) { return f.has_frames && formats.count(f.name); });
}

}  // namespace paperbake
