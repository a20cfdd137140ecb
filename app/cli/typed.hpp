#pragma once

#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "app/commands/report.hpp"
#include "app/commands/synth.hpp"
#include "app/commands/synth_training.hpp"
#include "app/commands/train.hpp"
#include "app/commands/view.hpp"
#include "app/lab/bench_classifier.hpp"
#include "app/lab/bench_desktop.hpp"
#include "app/lab/bench_paper.hpp"
#include "app/lab/bench_real.hpp"

namespace planescope::app {

// What was typed, before it is checked. Empty: not given.
struct Typed {
  std::vector<std::string> inputs;
  std::string frames, profile, gravity, intrinsics, depth_unit, instance_field, max_range, voxel,
      classifier;
  std::string method, labels, threads, out;
  std::vector<std::string> set;
  bool strict = false;  // labels check
  bool json = false;

  std::string seed, count, points, noise, scenes, size, evaluation_set, errors,
      recipe = "planescope";
  std::string network, steps, epoch, from, baseline, prediction;
  std::vector<std::string> weights;
  std::string rules, shard;
  bool approve = false, init = false, no_pictures = false;
  std::vector<std::string> shards;
  std::string only, rounds, sets, tuning_seed, doc;
  std::string frames_list, data, half, seeds;
  bool quick = false;
  bool axis_aligned = false, exact = false, depth_only = false, with_gravity = false,
       augmented = false, resume = false, balance_classes = false;

  std::string format, recording;

  std::string open, script, screenshot, state, scale;
  bool actions = false, offscreen = false, fresh = false;
};

// From text to values. All throw Error that names the option.
planes::PipelineOptions pipeline_options(const Typed& typed);
InputArgs input_args(const Typed& typed);
SynthSampleArgs sample_args(const Typed& typed);
SynthStairsArgs stairs_args(const Typed& typed);
SynthSetArgs set_args(const Typed& typed);
SynthTrainingArgs training_args(const Typed& typed);
TrainArgs train_args(const Typed& typed);
BenchClassifierArgs bench_classifier_args(const Typed& typed);
BenchPaperArgs bench_paper_args(const Typed& typed);
BenchRealArgs bench_real_args(const Typed& typed);
ViewArgs view_args(const Typed& typed);
BenchDesktopArgs bench_desktop_args(const Typed& typed);
ReportGuardArgs guard_args(const Typed& typed);
std::string required_out(const Typed& typed, const std::string& command);

/// The command line as one could type it again in a shell.
std::string command_text(int argc, char** argv);
/// Without what changes no frame of a report: where it is written, how it is run, what it is held
/// to.
std::string frames_command_text(int argc, char** argv);

}  // namespace planescope::app
