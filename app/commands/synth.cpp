// planescope synth sample and sequence. For evaluation and training sets, see planescope-lab synth.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/labels/model/label_files.hpp"

namespace planescope::app {
namespace {

struct SynthSampleArgs {
  std::filesystem::path out;  // -o
  lab::SampleOptions sample;
};

/// Writes a folder recording, with its labels beside it. Returns the exit code.
int run_synth_sample(const SynthSampleArgs& args, std::stop_token) {
  check_output_dir(args.out);
  lab::write_sample(args.out, args.sample);
  fmt::print("{}: {} frames, ground truth in {}\n", args.out.string(), args.sample.scenes.size(),
             labels::default_label_dir(args.out).string());
  return 0;
}

struct SynthSequenceArgs {
  std::filesystem::path out;  // -o
  lab::SequenceOptions sequence;
  int threads = all_cores();
};

int run_synth_sequence(const SynthSequenceArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  lab::write_sequence(args.out, args.sequence, args.threads, Bar("synth sequence", stop));
  fmt::print("{}: {} frames of a walk with poses, ground truth in {}\n", args.out.string(),
             args.sequence.frames, labels::default_label_dir(args.out).string());
  return 0;
}

void define_sequence(CLI::App* synth, Line& line) {
  CLI::App* sequence =
      synth->add_subcommand("sequence",
                            "Write a walk past boxes and up and down stairs\n"
                            "Camera poses are exact; the exact ground truth goes to DIR.labels.");
  const auto args = std::make_shared<SynthSequenceArgs>();
  lab::SequenceOptions& options = args->sequence;
  add_out(sequence, args->out)->required();
  add(sequence, "--frames", options.frames, "N", "Number of frames (default 300)")
      ->transform(whole(2, 100000));
  add(sequence, "--rate", options.rate_hz, "HZ", "Frames per second (default 15)")
      ->check(number(0.01, 1000));
  add_size(sequence, options.width, options.height, "Image size in pixels (default 640x480)", 16,
           16);
  add(sequence, "--seed", options.seed, "N", "Random seed (default 1)")->transform(whole(0));
  sequence->add_flag_callback(
      "--exact", [&options] { options.noise = false; }, "Depth without noise and holes");
  sequence->add_flag_callback(
      "--depth-only", [&options] { options.color = false; }, "Omit color images");
  sequence->add_flag_callback(
      "--no-imu", [&options] { options.imu = false; }, "Omit gravity");
  sequence->add_flag("--covered", options.covered,
                     "Leave ten frames in the middle without measurements");
  sequence->add_flag("--moved", options.moved, "Remove a box during the walk");
  add_threads(sequence, args->threads);
  runs(sequence, line, args, run_synth_sequence);
}

}  // namespace

void define_synth(CLI::App& app, Line& line) {
  CLI::App* synth = app.add_subcommand("synth", "Write synthetic recordings with ground truth");
  CLI::App* sample = synth->add_subcommand(
      "sample",
      "Write frames with the errors of a depth camera\nThe exact ground truth goes to DIR.labels.");
  const auto args = std::make_shared<SynthSampleArgs>();
  lab::SampleOptions& options = args->sample;
  add_out(sample, args->out)->required();
  add(sample, "--scenes", options.scenes, "NAME,...",
      fmt::format("Scenes, one frame each: {} (default stairs,kerb,boxes)",
                  fmt::join(lab::scene_names(), ", ")));
  add_size(sample, options.width, options.height, "Image size in pixels (default 640x480)");
  add(sample, "--seed", options.seed, "N", "Random seed of scenes and noise (default 1)")
      ->transform(whole(0));
  sample->add_flag_callback(
      "--exact", [&options] { options.noise = false; }, "Depth without noise and holes");
  sample->add_flag_callback(
      "--depth-only", [&options] { options.color = false; }, "Omit color images");
  sample->add_flag("--with-gravity", options.gravity, "Store the true gravity in the recording");
  runs(sample, line, args, run_synth_sample);
  define_sequence(synth, line);
}

}  // namespace planescope::app
