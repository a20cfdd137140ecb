#include "app/commands/training_data.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/progress.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/sha256.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::app {
namespace {

constexpr int kValidationEvery = 5;                // labelled frames
constexpr std::uint64_t kValidationSeed = 900001;  // no set that is trained on has it
constexpr double kRecordingShare = 0.5;            // of the clouds seen, where there are both
enum Stream : std::uint64_t { kFromRecording = 201, kWhich, kVariation };

bool has_label(const planes::LabelledCloud& cloud) {
  return std::any_of(cloud.labels.begin(), cloud.labels.end(),
                     [](Label label) { return label != Label::unknown; });
}

/// The frame's voxels with their labels; empty where it has no truth.
planes::LabelledCloud load_frame(const OpenInput& input,
                                 int index,
                                 const planes::PipelineOptions& options) {
  const Frame frame = input.recording->frame(index);
  const auto truth =
      labels::frame_truth(frame, input.label_dir, input.recording->frame_hash(index));
  if (!truth) return {};
  try {
    return planes::labelled_frame(frame, options, *truth);
  } catch (const Error& error) {
    throw Error(fmt::format("{}, frame {}: {}", input.path.string(), index, error.what()));
  }
}

std::string hash_of(const std::vector<planes::LabelledCloud>& clouds) {
  std::vector<std::byte> bytes;
  const auto append = [&](const auto& values) {
    const auto raw = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  for (const planes::LabelledCloud& cloud : clouds) {
    append(cloud.points);
    append(cloud.labels);
  }
  return sha256_hex(bytes);
}

}  // namespace

LabelledRecordings load_labelled_recordings(const InputArgs& args, const std::stop_token& stop) {
  LabelledRecordings recordings;
  if (args.inputs.empty()) return recordings;
  std::vector<planes::LabelledCloud> clouds;
  for (const OpenInput& input : open_inputs(args)) {
    Progress bar("recordings", static_cast<int>(input.frames.size()));
    int done = 0;
    for (const int index : input.frames) {
      if (stop.stop_requested()) throw Cancelled();
      bar.show(done++, input.path.string());
      if (!may_have_truth(input, index)) continue;
      planes::LabelledCloud cloud = load_frame(input, index, args.pipeline);
      if (has_label(cloud)) clouds.push_back(std::move(cloud));
    }
  }
  if (clouds.empty())
    throw Error(args.inputs[0].string() +
                ": no labelled frame to learn from, expected label files beside it or in --labels "
                "DIR, or a cloud's label field");
  recordings.sha256 = hash_of(clouds);
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const bool keep = i % kValidationEvery == kValidationEvery - 1;
    (keep ? recordings.validation : recordings.train).push_back(std::move(clouds[i]));
  }
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
                                const std::stop_token& stop) {
  TrainingData data{recipe, {}, std::move(recordings.train), {}};
  if (options.synthetic) {
    Progress bar("training set", recipe.set.count());
    data.synthetic = lab::make_training_set(recipe.set, options.threads, [&](int done, int) {
      if (stop.stop_requested()) throw Cancelled();
      bar.show(done, "clouds");
    });
  }
  data.validation =
      lab::make_validation_sets(kValidationSeed, options.validation_clouds, options.threads);
  if (!recordings.validation.empty())
    data.validation.push_back({"recordings", std::move(recordings.validation)});
  if (stop.stop_requested()) throw Cancelled();
  return data;
}

}  // namespace planescope::app
