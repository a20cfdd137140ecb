// planescope synth: its commands and their options.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "app/cli/cli_parts.hpp"
#include "app/commands/synth.hpp"
#include "app/commands/synth_training.hpp"
#include "core/lab/synthetic/scenes.hpp"

namespace planescope::app {
namespace {

using Choose = std::function<void(Job)>;

void define_sample(CLI::App* synth, Typed& t, const Choose& choose) {
  CLI::App* sample = synth->add_subcommand(
      "sample", "A recording as a depth camera makes it, and its exact ground truth in DIR.labels");
  add_out(sample, t);
  add(sample, "--scenes", t.scenes, "NAME,...",
      fmt::format("One frame each, of {}; default stairs,kerb,boxes",
                  fmt::join(lab::scene_names(), ", ")));
  add(sample, "--size", t.size, "WxH", "Of the pictures in pixels, default 640x480");
  add(sample, "--seed", t.seed, "N", "Another seed makes other scenes and noise, default 1");
  sample->add_flag("--exact", t.exact, "Depth without noise and holes");
  sample->add_flag("--depth-only", t.depth_only, "No colour");
  sample->add_flag("--with-gravity", t.with_gravity, "State the true gravity in the recording");
  sample->final_callback([&t, choose] {
    choose([args = sample_args(t)](std::stop_token) { return run_synth_sample(args); });
  });
}

void define_stairs(CLI::App* synth, Typed& t, const Choose& choose) {
  CLI::App* stairs = synth->add_subcommand(
      "stairs", "The paper's evaluation set: stairs as PLY clouds with label and instance");
  add_out(stairs, t);
  add(stairs, "--count", t.count, "N", "How many stairs, default 100");
  add(stairs, "--points", t.points, "N", "Points of each, default 8192; 0 = dense sampling");
  add(stairs, "--noise", t.noise, "M",
      "Standard deviation of the noise, added after the sampling; default 0");
  add(stairs, "--seed", t.seed, "N", "Another seed makes another set, default 1");
  stairs->add_flag("--axis-aligned", t.axis_aligned, "Do not turn the stairs about z");
  add(stairs, "--threads", t.threads, "N", "Default: all cores");
  stairs->final_callback([&t, choose] {
    choose([args = stairs_args(t)](std::stop_token stop) { return run_synth_stairs(args, stop); });
  });
}

void define_set(CLI::App* synth, Typed& t, const Choose& choose) {
  std::string names = "One of";
  for (const lab::EvaluationSet& set : lab::evaluation_sets())
    names += "\n" + wrapped(set.name + ": " + set.meaning);
  CLI::App* command = synth->add_subcommand(
      "set", "A set that methods are measured on: PLY clouds, or depth and its DIR.labels");
  command->add_option("NAME", t.evaluation_set, names)->type_name("")->required();
  add_out(command, t);
  add(command, "--count", t.count, "N", "How many frames; default as many as are measured on");
  add(command, "--points", t.points, "N",
      "Clouds: points of each, default 8192; 0 = dense sampling");
  add(command, "--noise", t.noise, "M",
      "Clouds: standard deviation of the noise on every coordinate, default 0");
  add(command, "--errors", t.errors, "clean|noise|d435",
      "Depth: exact (default), independent noise on every pixel, or the whole camera model");
  add(command, "--seed", t.seed, "N", "Another seed makes another set, default 1");
  add(command, "--threads", t.threads, "N", "Default: all cores");
  command->final_callback([&t, choose] {
    choose([args = set_args(t)](std::stop_token stop) { return run_synth_set(args, stop); });
  });
}

void define_training(CLI::App* synth, Typed& t, const Choose& choose) {
  CLI::App* training = synth->add_subcommand(
      "training", "What the classifier learns from: labelled PLY clouds, and training.json");
  add_out(training, t);
  add(training, "--recipe", t.recipe, "NAME",
      fmt::format("{}; default {}: the paper's shapes and scans of scenes made of them",
                  fmt::join(lab::recipe_names(), ", "), t.recipe));
  add(training, "--count", t.count, "N", "At most so many clouds of each kind; default all");
  training->add_flag("--augmented", t.augmented,
                     "Noise, turns and holes as one step of training adds them");
  add(training, "--seed", t.seed, "N", "Another seed makes another set, default 1");
  add(training, "--threads", t.threads, "N", "Default: all cores");
  training->final_callback([&t, choose] {
    choose(
        [args = training_args(t)](std::stop_token stop) { return run_synth_training(args, stop); });
  });
}

}  // namespace

void define_synth(CLI::App& app, Typed& typed, const std::function<void(Job)>& choose) {
  CLI::App* synth = app.add_subcommand("synth", "Write synthetic recordings with ground truth");
  synth->require_subcommand(0, 1);  // `synth set stairs` names a set, not `synth stairs`
  define_sample(synth, typed, choose);
  define_stairs(synth, typed, choose);
  define_set(synth, typed, choose);
  define_training(synth, typed, choose);
}

}  // namespace planescope::app
