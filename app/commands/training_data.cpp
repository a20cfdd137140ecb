// Training data from synthetic sets and labeled recordings, and a record of their origin.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/progress.hpp"
#include "app/commands/train.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::app {
namespace {

constexpr std::uint64_t kValidationSeed = 900001;  // not used by any training set
constexpr double kRecordingShare = 0.5;            // share of recorded clouds, if both exist
enum Stream : std::uint64_t { kFromRecording = 201, kWhich, kVariation };

bool has_label(const planes::LabeledCloud& cloud) {
  return std::any_of(cloud.labels.begin(), cloud.labels.end(),
                     [](Label label) { return label != Label::unknown; });
}

std::string hash_of(const std::vector<LabeledFrame>& frames) {
  std::vector<std::byte> bytes;
  const auto append = [&](const auto& values) {
    const auto raw = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  for (const LabeledFrame& frame : frames) {
    append(frame.cloud.points);
    append(frame.cloud.labels);
  }
  return sha256_hex(bytes);
}

}  // namespace

LabeledFrame make_labeled_frame(const Frame& frame,
                                const planes::SourceTruth& truth,
                                std::string sha256,
                                const planes::PipelineOptions& options) {
  LabeledFrame labeled{planes::labeled_frame(frame, options, truth), std::move(sha256)};
  if (!has_label(labeled.cloud)) labeled.cloud = {};
  return labeled;
}

LabeledRecordings labeled_recordings(std::vector<LabeledFrame> frames) {
  LabeledRecordings recordings;
  std::erase_if(frames, [](const LabeledFrame& frame) { return frame.cloud.points.empty(); });
  if (frames.empty()) return recordings;
  recordings.sha256 = hash_of(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    (is_kept_for_validation(i) ? recordings.validation : recordings.train)
        .push_back(std::move(frames[i].cloud));
    recordings.frames.push_back(std::move(frames[i].sha256));
  }
  return recordings;
}

LabeledRecordings load_labeled_recordings(const InputArgs& args,
                                          const std::filesystem::path& out,
                                          const std::stop_token& stop) {
  if (args.inputs.empty()) return {};
  std::vector<LabeledFrame> frames;
  int code = 0;
  for (const OpenInput& input : open_inputs(args, out)) {
    const DamagedFrames damaged = for_each_frame("recordings", input.frames, stop, [&](int index) {
      if (!may_have_truth(input, index)) return;
      const Frame frame = input.frame(index);
      const std::string hash = input.recording->frame_hash(index);
      const auto truth = input.truth(frame);
      if (!truth) return;
      try {
        frames.push_back(make_labeled_frame(frame, *truth, hash, args.pipeline));
      } catch (const Error& error) {
        throw Error(fmt::format("{}, frame {}: {}", input.path.string(), index, error.what()));
      }
    });
    code = std::max(code, damaged.report(input.frames.size()));
  }
  LabeledRecordings recordings = labeled_recordings(std::move(frames));
  if (recordings.frames.empty())
    throw Error(args.inputs[0].string() +
                ": no labeled frames; expected label files next to it or in --labels DIR, or a "
                "cloud's label field");
  recordings.code = code;
  return recordings;
}

planes::LabeledCloud TrainingData::draw(std::uint64_t number) const {
  const std::uint64_t seed = recipe.train.seed;
  const double share = synthetic.empty() ? 1 : recordings.empty() ? 0 : kRecordingShare;
  if (lab::random_uniform(seed, kFromRecording, number) >= share)
    return lab::draw_cloud(recipe, synthetic, number);
  const std::uint64_t which = lab::random_bits(seed, kWhich, number) % recordings.size();
  return lab::augment(recordings[which], recipe.scans, lab::random_bits(seed, kVariation, number));
}

TrainingData make_training_data(const lab::TrainingRecipe& recipe,
                                const TrainingDataOptions& options,
                                LabeledRecordings recordings,
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

// Training record for weight files and checkpoints.

using Json = nlohmann::ordered_json;

Json json_of(const lab::TrainingSetOptions& set) {
  Json json = {{"stairs", set.stairs},
               {"boxes", set.boxes},
               {"planes", set.planes},
               {"boxes_on_floor", set.boxes_on_floor},
               {"scans", set.scans},
               {"points", set.points},
               {"voxel_size_m", set.voxel_size_m}};
  // Omitted when off, so that records of older weights stay the same.
  if (set.real_errors) json["real_errors"] = true;
  return json;
}

Json json_of(const lab::AugmentOptions& options) {
  return {{"uniform_noise_m", options.uniform_noise_m},
          {"gaussian_noise_m", options.gaussian_noise_m},
          {"clusters", options.clusters},
          {"cluster_radius_m", options.cluster_radius_m},
          {"tilt_deg", options.tilt_deg},
          {"points", options.points},
          {"thinning", options.thinning},
          {"yaw_deg", options.yaw_deg}};
}

lab::TrainingPurpose training_purpose(const TrainArgs& args, const LabeledRecordings& recordings) {
  const lab::TrainingRecipe& recipe = args.recipe;
  const auto hash_or_none = [](const std::string& hash) { return hash.empty() ? "none" : hash; };
  return {{"recipe", recipe.name},
          {"synthetic clouds", args.synthetic ? json_of(recipe.set).dump() : "none"},
          {"variation of objects", json_of(recipe.objects).dump()},
          {"variation of scans", json_of(recipe.scans).dump()},
          {"share of scans", Json(recipe.scan_share).dump()},
          {"share of uniform noise", Json(recipe.uniform_share).dump()},
          {"clouds to validate with", Json(args.validation_clouds).dump()},
          {"weights to begin with", args.from.empty() ? "none" : sha256_hex_of_file(args.from)},
          {"recordings", hash_or_none(recordings.sha256)}};
}

std::string training_record(const TrainArgs& args,
                            const TrainingData& data,
                            const lab::TrainState& state,
                            const lab::TrainingPurpose& purpose) {
  const lab::TrainOptions& options = args.recipe.train;
  Json record = {{"recipe", args.recipe.name},
                 {"seed", options.seed},
                 {"steps", state.step},
                 {"batch", options.batch},
                 {"learning_rate", options.learning_rate},
                 {"warm_up_steps", options.warm_up_steps},
                 {"edge_weight", options.edge_weight},
                 {"balance_classes", options.balance_classes},
                 {"planescope", PLANESCOPE_VERSION},
                 {"from", purpose.at("weights to begin with")},
                 {"recordings", purpose.at("recordings")},
                 {"recorded_clouds", data.recordings.size()},
                 {"frames", data.frames},
                 {"synthetic_clouds", data.synthetic.size()}};
  if (args.synthetic)
    record["synthetic"] = {{"set", json_of(args.recipe.set)},
                           {"objects", json_of(args.recipe.objects)},
                           {"scan_share", args.recipe.scan_share},
                           {"uniform_share", args.recipe.uniform_share}};
  record["scans"] = json_of(args.recipe.scans);
  record["loss"] = state.epochs.back().train_loss;
  for (std::size_t s = 0; s < data.validation.size(); ++s) {
    const planes::LabelAccuracy& a = state.epochs.back().validation[s];
    record["validation"][data.validation[s].name] = {{"edge", a.edge_percent()},
                                                     {"inner", a.inner_percent()}};
  }
  return record.dump();
}

}  // namespace planescope::app
