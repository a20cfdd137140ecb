#pragma once

// What `planescope bench real` measured: methods by pixel, on labelled frames of real recordings,
// on synthetic depth frames, and on neighbouring frames of a recording.

#include <filesystem>
#include <string>
#include <vector>

#include "core/lab/experiments/repeatability.hpp"
#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

/// What a labelled frame is for: to tune a method on, or to print its figures.
enum class Half : std::uint8_t { tuning, printed };
const char* to_string(Half half);
Half parse_half(const std::string& text);  // throws Error

/// Which frame of which recording.
struct LabelledName {
  std::string name;  // of the folder that its labels lie in
  Half half = Half::tuning;
  std::string recording;  // below the folder of recordings
  int frame = 0;
};

/// How a method did on each of some frames.
struct MethodScores {
  CellKey method;  // of no frames
  std::vector<planes::Metrics> of_frames;
};

struct LabelledScores {
  std::vector<LabelledName> frames;
  std::vector<MethodScores> methods;
};

/// Frames of a depth set from one seed.
struct SetScores {
  CellKey frames;  // of no method
  std::vector<MethodScores> methods;
};

struct RepeatScores {
  std::string recording;  // below the folder of recordings
  int frames = 0;         // from the first on
  struct OfMethod {
    CellKey method;
    std::vector<Neighbours> neighbours;  // frames i and i + 1
    std::vector<FloorPieces> floor;      // by frame
  };
  std::vector<OfMethod> methods;
};

/// The same for the same input, options and weights, on any machine. What was not measured is
/// empty.
struct RealResults {
  std::string command;  // that measures the same again, without folders and threads
  report::BuildInfo build;
  planes::WeightsRecord weights;
  LabelledScores labelled;
  std::vector<SetScores> sets;
  RepeatScores repeat;
};

/// real.json, "planescope.real/1".
std::string real_json(const RealResults& results);

}  // namespace planescope::lab
