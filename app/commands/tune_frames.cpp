#include "app/commands/tune_frames.hpp"

#include <fmt/format.h>

#include <optional>

#include "app/commands/input_list.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

/// Recordings with options of their own, and whether the list says that they are held out.
struct Listed {
  InputArgs input;
  std::optional<bool> held;
};

bool parse_held(const std::string& text) {
  if (text == "held-out") return true;
  if (text == "tuning") return false;
  throw Error("HALF: '" + text + "' is unknown, expected tuning, held-out or -");
}

/// Lines of HALF RECORDING OPTIONS, beside what was typed. Paths are from the list's folder on.
std::vector<Listed> read_tune_list(const TuneArgs& args) {
  static const std::vector<std::string> options = {"--frames",   "--intrinsics",     "--depth-unit",
                                                   "--gravity",  "--instance-field", "--labels",
                                                   "--max-range"};
  if (!args.input.inputs.empty())
    throw Error("--list names the recordings: leave out " + args.input.inputs[0].string());
  const fs::path folder = fs::absolute(args.list).parent_path();
  std::vector<Listed> all;
  read_list(args.list, [&](std::istringstream& words) {
    std::string half, recording;
    if (!(words >> half >> recording)) throw Error("expected HALF RECORDING OPTIONS");
    Listed listed{args.input, {}};
    if (half != "-") listed.held = parse_held(half);
    set_listed_options(listed.input, words, options);
    listed.input.inputs = {folder / recording};
    if (listed.input.label_dir) listed.input.label_dir = folder / *listed.input.label_dir;
    if (!all.empty() && all[0].held.has_value() != listed.held.has_value())
      throw Error("some lines name a half and others do not");
    all.push_back(std::move(listed));
  });
  if (all.empty()) throw Error(args.list.string() + ": no recording");
  return all;
}

std::string hash_of(const planes::SourceTruth& truth) {
  return sha256_hex(std::as_bytes(std::span(truth.values.instance))) +
         sha256_hex(std::as_bytes(std::span(truth.values.label)));
}

}  // namespace

TuneFrames read_tune_frames(const TuneArgs& args) {
  std::vector<Listed> all;
  if (args.list.empty())
    all.push_back({args.input, {}});
  else
    all = read_tune_list(args);
  TuneFrames frames;
  int count = 0;
  for (Listed& listed : all) {
    listed.input.recording.color = false;
    for (const OpenInput& input : open_inputs(listed.input))
      for (const int index : input.frames) {
        if (!may_have_truth(input, index)) continue;
        lab::TuningFrame frame;
        frame.frame = input.frame(index);
        const std::string hash = input.recording->frame_hash(index);
        auto truth = labels::frame_truth(frame.frame, input.label_dir, hash);
        if (!truth) continue;
        frame.name = fmt::format("{} {}", input.path.filename().string(), index);
        frame.hash = hash + hash_of(*truth);
        frame.truth = std::move(*truth);
        frame.options = listed.input.pipeline;
        const bool held = listed.held.value_or(++count % args.hold_out == 0);
        (held ? frames.held : frames.tuning).push_back(std::move(frame));
      }
  }
  if (frames.tuning.empty() || frames.held.empty())
    throw Error(fmt::format(
        "tune needs labelled frames to search on and others to hold out, found {} and {}; "
        "`planescope view` labels them, --labels DIR says where labels are",
        frames.tuning.size(), frames.held.size()));
  return frames;
}

}  // namespace planescope::app
