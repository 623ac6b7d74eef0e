#include "baker/output/cache_writers.h"

#include "baker/job/output_formats.h"

#include <algorithm>

namespace paperbake {

CacheWriters::CacheWriters(const std::set<std::string>& formats, const WriterInput& input,
                           BakeFiles& files)
    : frames_(input.plan.frames), files_(files), frames_added_(input.plan.shots.size(), 0) {
  for (const OutputFormat& format : output_formats())
    if (format.has_frames && formats.count(format.name))
      writers_.push_back(maker_of_writer(format.name)(input));
}

bool CacheWriters::store_crease_attributes() const {
  return std::any_of(writers_.begin(), writers_.end(),
                     [](const auto& writer) { return writer->stores_crease_attributes(); });
}

bool CacheWriters::show_maps() const {
  return std::any_of(writers_.begin(), writers_.end(),
                     [](const auto& writer) { return writer->shows_maps(); });
}

FrameSpan CacheWriters::frames_shown() const {
  const auto count = [](const FrameSpan& span) { return (span.last - span.first) / span.step; };
  FrameSpan widest = frames_;
  for (std::size_t w = 0; w < writers_.size(); ++w)
    if (const FrameSpan span = writers_[w]->frames_shown(frames_);
        w == 0 || count(span) > count(widest))
      widest = span;
  return widest;
}

std::string CacheWriters::add_frame(std::size_t sheet, int number, const CacheFrame& frame) {
  std::string hash;
  ++frames_added_.at(sheet);
  for (const auto& writer : writers_)
    files_.failures.try_write(writer->file(sheet), [&] {
      const std::string own = writer->add_frame(sheet, number, frame);
      if (!own.empty()) hash = own;
    });
  return hash;
}

void CacheWriters::add_map(const std::string& caption, const std::string& png) {
  for (const auto& writer : writers_)
    if (writer->shows_maps()) writer->add_map(caption, png);
}

std::vector<std::size_t> CacheWriters::finish(const FinishedFrames& shot) {
  std::vector<std::size_t> with_hash(shot.frames.size(), 0);
  for (const auto& writer : writers_)
    if (std::vector<std::size_t> own = writer->finish(shot, files_); !own.empty())
      with_hash = std::move(own);
  return with_hash;
}

void CacheWriters::write_ending(const BakeEnding& ending) {
  for (const auto& writer : writers_) writer->write_ending(ending, files_);
}

}  // namespace paperbake
