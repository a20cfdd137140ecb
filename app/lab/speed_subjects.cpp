#include "app/lab/speed_subjects.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/error.hpp"

namespace planescope::app {
namespace {

constexpr std::size_t kMostFrames = 10;

}  // namespace

std::shared_ptr<OpenSubject> read_subject(OpenInput input, const planes::PipelineOptions& options) {
  const auto open = std::make_shared<OpenSubject>();
  open->input = std::move(input);
  const io::Recording& recording = *open->input.recording;
  lab::SpeedSubject& subject = open->subject;
  subject.name = std::filesystem::absolute(open->input.path / "").parent_path().filename().string();
  subject.options = options;
  const std::vector<int>& all = open->input.frames;
  const std::size_t used = std::min(all.size(), kMostFrames);
  std::string refusal;
  for (std::size_t i = 0; i < used; ++i) {
    const int number = all[i * all.size() / used];
    Frame frame = recording.frame(number);
    try {
      const Gravity gravity = planes::resolve_gravity(frame, options.gravity);
      const planes::Cloud cloud = planes::make_cloud(frame, gravity, options.cloud);
      if (cloud.counts.kept == 0) throw Error("nothing of it is within range");
    } catch (const Error& error) {
      refusal = fmt::format("{}, frame {}: {}", open->input.path.string(), number, error.what());
      continue;
    }
    open->numbers.push_back(number);
    subject.frames.push_back(std::move(frame));
  }
  if (subject.frames.empty()) throw Error(refusal);
  subject.load = [&recording, numbers = open->numbers](std::size_t i) {
    return recording.frame(numbers[i]);
  };
  return open;
}

std::shared_ptr<OpenSubject> made_subject(const planes::PipelineOptions& options) {
  const auto made = std::make_shared<OpenSubject>();
  const lab::EvaluationSet& set = lab::find_evaluation_set("depth_stairs");
  made->subject.name = "depth_stairs, d435";
  made->subject.options = options;
  for (int i = 0; i < std::min(set.frames, static_cast<int>(kMostFrames)); ++i)
    made->subject.frames.push_back(
        lab::make_evaluation_frame(set, i, {.errors = lab::DepthErrors::d435}).frame);
  return made;
}

}  // namespace planescope::app
