#include "baker/job/output_formats.h"

#include "baker/output/frame_writer.h"

#include <algorithm>

namespace paperbake {

const std::vector<OutputFormat>& output_formats() {
  static const std::vector<OutputFormat> formats{
      {"abc", "NAME.abc", "Alembic cache of all sheets", true, false, make_alembic_writer},
      {"maps", "maps/NAME.####.exr", "crease and apex maps", true, false, nullptr},
      {"cert", "cert/frames.jsonl", "certificate of every frame", true, false, nullptr},
      {"report", "report.html", "page with animation, curves and maps", true, false,
       make_report_writer},
      {"usd", "NAME.usda", "USD layer of all sheets", false, false, make_usd_writer},
      {"usdc", "NAME.usdc", "the same in binary form", false, false, make_usdc_writer},
      {"pc2", "NAME.pc2", "point cache of each sheet with its NAME.rest.obj", false, true,
       make_pc2_writer},
      {"preview", "NAME.preview.png", "picture of up to 16 frames", false, false,
       make_preview_writer},
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
                     [&](const OutputFormat& f) { return f.make_writer && formats.count(f.name); });
}

}  // namespace paperbake
