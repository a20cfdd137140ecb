#include "app/commands/training_data.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/progress.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::app {
namespace {

constexpr std::uint64_t kValidationSeed = 900001;  // no set that is trained on has it
constexpr double kRecordingShare = 0.5;            // of the clouds seen, where there are both
enum Stream : std::uint64_t { kFromRecording = 201, kWhich, kVariation };

bool has_label(const planes::LabelledCloud& cloud) {
  return std::any_of(cloud.labels.begin(), cloud.labels.end(),
                     [](Label label) { return label != Label::unknown; });
}

std::string hash_of(const std::vector<LabelledFrame>& frames) {
  std::vector<std::byte> bytes;
  const auto append = [&](const auto& values) {
    const auto raw = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  for (const LabelledFrame& frame : frames) {
    append(frame.cloud.points);
    append(frame.cloud.labels);
  }
  return sha256_hex(bytes);
}

}  // namespace

LabelledFrame make_labelled_frame(const Frame& frame,
                                  const planes::SourceTruth& truth,
                                  std::string sha256,
                                  const planes::PipelineOptions& options) {
  LabelledFrame labelled{planes::labelled_frame(frame, options, truth), std::move(sha256)};
  if (!has_label(labelled.cloud)) labelled.cloud = {};
  return labelled;
}

LabelledRecordings labelled_recordings(std::vector<LabelledFrame> frames) {
  LabelledRecordings recordings;
  std::erase_if(frames, [](const LabelledFrame& frame) { return frame.cloud.points.empty(); });
  if (frames.empty()) return recordings;
  recordings.sha256 = hash_of(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    (is_kept_for_validation(i) ? recordings.validation : recordings.train)
        .push_back(std::move(frames[i].cloud));
    recordings.frames.push_back(std::move(frames[i].sha256));
  }
  return recordings;
}

LabelledRecordings load_labelled_recordings(const InputArgs& args, const std::stop_token& stop) {
  if (args.inputs.empty()) return {};
  std::vector<LabelledFrame> frames;
  for (const OpenInput& input : open_inputs(args)) {
    Progress bar("recordings", static_cast<int>(input.frames.size()));
    int done = 0;
    for (const int index : input.frames) {
      if (stop.stop_requested()) throw Cancelled();
      bar.show(done++, input.path.string());
      if (!may_have_truth(input, index)) continue;
      const Frame frame = input.frame(index);
      const std::string hash = input.recording->frame_hash(index);
      const auto truth = labels::frame_truth(frame, input.label_dir, hash);
      if (!truth) continue;
      try {
        frames.push_back(make_labelled_frame(frame, *truth, hash, args.pipeline));
      } catch (const Error& error) {
        throw Error(fmt::format("{}, frame {}: {}", input.path.string(), index, error.what()));
      }
    }
  }
  LabelledRecordings recordings = labelled_recordings(std::move(frames));
  if (recordings.frames.empty())
    throw Error(args.inputs[0].string() +
                ": no labelled frame to learn from, expected label files beside it or in --labels "
                "DIR, or a cloud's label field");
  return recordings;
}

planes::LabelledCloud TrainingData::draw(std::uint64_t number) const {
  const std::uint64_t seed = recipe.train.seed;
  const double share = synthetic.empty() ? 1 : recordings.empty() ? 0 : kRecordingShare;
  if (lab::random_uniform(seed, kFromRecording, number) >= share)
    return lab::draw_cloud(recipe, synthetic, number);
  const std::uint64_t which = lab::random_bits(seed, kWhich, number) % recordings.size();
  return lab::augment(recordings[which], recipe.scans, lab::random_bits(seed, kVariation, number));
}

TrainingData make_training_data(const lab::TrainingRecipe& recipe,
                                const TrainingDataOptions& options,
                                LabelledRecordings recordings,
                                const std::function<void(int, int)>& progress) {
  TrainingData data{recipe, {}, std::move(recordings.train), {}, std::move(recordings.frames)};
  if (options.synthetic)
    data.synthetic = lab::make_training_set(recipe.set, options.threads, progress);
  data.validation =
      lab::make_validation_sets(kValidationSeed, options.validation_clouds, options.threads);
  if (!recordings.validation.empty())
    data.validation.push_back({kRecordingsSet, std::move(recordings.validation)});
  return data;
}

}  // namespace planescope::app
