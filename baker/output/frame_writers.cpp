#include "baker/job/version.h"
#include "baker/output/frame_writer.h"
#include "baker/output/preview.h"
#include "baker/output/report.h"
#include "formats/cache/pc2_cache.h"
#include "formats/cache/usd_cache.h"
#include "formats/files/atomic_file.h"

#include <fmt/format.h>
#include <map>

namespace paperbake {
namespace {

CacheInfo cache_info(const BakePlan& plan) {
  return {plan.animation.fps,
          plan.frames.first,
          plan.frames.step,
          {{"paperbake_version", program_version}, {"paperbake_job", plan.job_hash}},
          plan.root};
}

std::vector<std::string> sheet_names(const BakePlan& plan) {
  std::vector<std::string> names;
  for (const Shot& shot : plan.shots) names.push_back(shot.sheet_name);
  return names;
}

/// Number of the n-th frame that is written.
std::function<int(std::size_t)> numbering(const FrameSpan& frames) {
  return [frames](std::size_t n) { return frames.first + frames.step * static_cast<int>(n); };
}

class AlembicFrameWriter : public FrameWriter {
 public:
  explicit AlembicFrameWriter(const WriterInput& input)
      : file_(input.plan.name + ".abc"),
        frames_(input.plan.frames),
        writer_(input.folder / file_, cache_info(input.plan), sheet_names(input.plan)) {}

  std::string file(std::size_t) const override { return file_; }
  std::string add_frame(std::size_t sheet, int, const CacheFrame& frame) override {
    return writer_.add_frame(sheet, frame);
  }
  std::vector<std::size_t> finish(const FinishedFrames& shot, BakeFiles& files) override {
    return files.finish_cache(
        file_, shot.frames, [&] { return writer_.finish(); }, numbering(frames_));
  }

 private:
  std::string file_;
  FrameSpan frames_;
  AlembicWriter writer_;
};

class UsdFrameWriter : public FrameWriter {
 public:
  UsdFrameWriter(const WriterInput& input, UsdEncoding encoding)
      : file_(input.plan.name + (encoding == UsdEncoding::text ? ".usda" : ".usdc")),
        has_layers_(input.plan.usd_layers),
        writer_(input.folder / file_, encoding, cache_info(input.plan), sheet_names(input.plan),
                has_layers_ ? UsdLayers::separate : UsdLayers::one) {}

  std::string file(std::size_t) const override { return file_; }
  bool stores_crease_attributes() const override { return true; }
  std::string add_frame(std::size_t sheet, int, const CacheFrame& frame) override {
    writer_.add_frame(sheet, frame);
    return {};
  }
  std::vector<std::size_t> finish(const FinishedFrames&, BakeFiles& files) override {
    if (files.write(file_, [&](const auto&) { writer_.finish(); }) && has_layers_)
      for (const char* part : {"asset", "animation"})
        files.add(usd_part_path(file_, part).string());
    return {};
  }

 private:
  std::string file_;
  bool has_layers_;
  UsdWriter writer_;
};

class Pc2FrameWriter : public FrameWriter {
 public:
  explicit Pc2FrameWriter(const WriterInput& input) : plan_(input.plan) {
    for (const PlannedSheet& sheet : plan_.sheets) {
      names_.push_back(plan_.name + sheet.file_suffix);
      writers_.push_back(std::make_unique<Pc2Writer>(input.folder / (names_.back() + ".pc2"),
                                                     input.folder / (names_.back() + ".rest.obj"),
                                                     cache_info(plan_)));
    }
  }

  std::string file(std::size_t sheet) const override { return names_[sheet] + ".pc2"; }
  std::string add_frame(std::size_t sheet, int, const CacheFrame& frame) override {
    writers_[sheet]->add_frame(frame, longer_side(plan_.shots[sheet].pattern));
    return {};
  }
  std::vector<std::size_t> finish(const FinishedFrames& shot, BakeFiles& files) override {
    for (std::size_t s = 0; s < writers_.size(); ++s) {
      const auto kept = files.finish_cache(
          file(s), {shot.frames[s]},
          [&] { return std::vector<std::size_t>{writers_[s]->finish()}; }, numbering(plan_.frames));
      if (kept.front() > 0) files.add(names_[s] + ".rest.obj");
    }
    return {};
  }

 private:
  const BakePlan& plan_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<Pc2Writer>> writers_;
};

class ReportFrameWriter : public FrameWriter {
 public:
  explicit ReportFrameWriter(const WriterInput& input)
      : report_(
            input.plan,
            static_cast<std::size_t>(
                (input.plan.frames.last - input.plan.frames.first) / input.plan.frames.step + 1)) {}

  std::string file(std::size_t) const override { return "report.html"; }
  bool shows_maps() const override { return true; }
  std::string add_frame(std::size_t sheet, int, const CacheFrame& frame) override {
    report_.add_frame(sheet, frame);
    return {};
  }
  void add_map(const std::string& caption, const std::string& png) override {
    report_.add_map(caption, png);
  }
  std::vector<std::size_t> finish(const FinishedFrames& shot, BakeFiles&) override {
    report_.set_handles(shot.handles);
    return {};
  }
  void write_ending(const BakeEnding& ending, BakeFiles& files) override {
    files.write(file(0), [&](const auto& path) { write_atomically(path, report_.html(ending)); });
  }

 private:
  Report report_;
};

class PreviewFrameWriter : public FrameWriter {
 public:
  explicit PreviewFrameWriter(const WriterInput& input)
      : file_(input.plan.name + ".preview.png"),
        preview_(
            fmt::format("{}, {}, {}, seed {}, frames {}-{}", input.plan.name, input.plan.method,
                        input.plan.sheets.front().preset, input.plan.sheets.front().seed,
                        input.plan.frames.first, input.plan.frames.last),
            input.plan.frames, input.plan.shots.front().colliders,
            input.plan.animation.first_frame) {}

  std::string file(std::size_t) const override { return file_; }
  FrameSpan frames_shown(const FrameSpan& written) const override {
    return preview_frames(written);
  }
  std::string add_frame(std::size_t, int number, const CacheFrame& frame) override {
    preview_.add_frame(number, frame);
    return {};
  }
  std::vector<std::size_t> finish(const FinishedFrames& shot, BakeFiles&) override {
    preview_.add_handles(shot.handles);
    return {};
  }
  void write_ending(const BakeEnding& ending, BakeFiles& files) override {
    const char* verdict = ending.missed.empty() ? "" : ", gate missed";
    files.write(file_, [&](const auto& path) { write_png(path, preview_.picture(verdict)); });
  }

 private:
  std::string file_;
  Preview preview_;
};

template <class Writer>
std::unique_ptr<FrameWriter> make_writer(const WriterInput& input) {
  return std::make_unique<Writer>(input);
}

template <UsdEncoding encoding>
std::unique_ptr<FrameWriter> make_usd_writer(const WriterInput& input) {
  return std::make_unique<UsdFrameWriter>(input, encoding);
}

}  // namespace

MakeWriter maker_of_writer(const std::string& format) {
  static const std::map<std::string, MakeWriter> makers{
      {"abc", make_writer<AlembicFrameWriter>},     {"pc2", make_writer<Pc2FrameWriter>},
      {"preview", make_writer<PreviewFrameWriter>}, {"report", make_writer<ReportFrameWriter>},
      {"usd", make_usd_writer<UsdEncoding::text>},  {"usdc", make_usd_writer<UsdEncoding::crate>},
  };
  const auto found = makers.find(format);
  return found == makers.end() ? nullptr : found->second;
}

}  // namespace paperbake
