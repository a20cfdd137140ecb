#pragma once

// What `planescope-lab bench real` measured: methods by pixel, on labelled frames of real
// recordings, on synthetic depth frames, and on neighbouring frames of a recording; and what that
// sums up to.

#include <filesystem>
#include <string>
#include <vector>

#include "core/lab/bench/measuring.hpp"
#include "core/lab/bench/table.hpp"
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

// ---- Summed up: what the tables print and real.json repeats ----

/// A method on the frames of one half.
struct HalfSummary {
  Half half = Half::tuning;
  CellKey method;
  int frames = 0;
  MeanAndDeviation mean_iou, pq;  // over frames
  planes::Metrics metrics;        // mean_of() the frames: its counts are sums
};
/// By half, then by method. Halves of which no frame was measured are left out.
std::vector<HalfSummary> half_summaries(const LabelledScores& scores);

/// A figure of a seed's frames, of which there are `frames`; `metrics` is their mean_of().
struct SeedFigure {
  const char* name;    // in real.json
  const char* column;  // of the tables
  int digits;
  bool more_is_better;
  double (*value)(const planes::Metrics& metrics, int frames);
};
const std::vector<SeedFigure>& seed_figures();

/// A figure over the seeds.
struct OverSeeds {
  MeanAndDeviation spread;
  double worst = 0;  // seed's value
};

/// A method on a depth set, or on all three.
struct SetSummary {
  std::string set;  // empty: all that were measured, each frame as much as any other
  std::string errors;
  CellKey method;
  int seeds = 0, frames = 0;       // of one seed
  std::vector<OverSeeds> figures;  // as seed_figures()
};
/// By set, with all of them last, by errors, then by method.
std::vector<SetSummary> set_summaries(const std::vector<SetScores>& sets);

/// A method on neighbouring frames of a recording.
struct RepeatSummary {
  CellKey method;
  int planes = 0, partners = 0;  // of all frames but the last
  // Medians over partners, 0 where there are none.
  double offset_jump_m = 0, normal_jump_deg = 0;
  // Of angles between two of them: how many, % that changed by no more than 2 sigma, and the root
  // mean square of their changes in sigma.
  int angles = 0;
  double angles_within = 0, angle_jump_sigmas = 0;
  // Means over frames.
  double floor_pieces = 0, floor_largest = 0, floor_missing = 0;
  int frames_of_one_floor = 0;  // whose floor's largest piece has at least kWholeFloor
};
inline constexpr double kWholeFloor = 97;  // %
std::vector<RepeatSummary> repeat_summaries(const RepeatScores& scores);

// ---- For people ----

/// Halves, frames, sets, neighbouring frames: of what was measured.
std::vector<Table> real_tables(const RealResults& results);

/// real.md.
std::string real_markdown(const RealResults& results);

}  // namespace planescope::lab
