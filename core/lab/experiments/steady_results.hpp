#pragma once

// What `planescope-lab bench steady` measured, and its sums.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/steadiness.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::lab {

enum class SteadyPart : std::uint8_t { gravity, focal, rounded, dither, next };
const std::vector<SteadyPart>& steady_parts();  // in the order of the table
const char* to_string(SteadyPart part);         // as --only has it

/// A frame against itself after a change, or against the next frame.
struct SteadyPair {
  Agreement planes;
  int count_difference = 0;  // planes found in the one and not in the other, without sign
  // Partners of which one is h and the other v: how many, and the sum of the angles between their
  // normals (those of the first image) and the limit between h and v [deg].
  int label_changes = 0;
  double label_changes_deg = 0;
  int report_errors = 0;  // that `report --baseline` prints with its built-in rules
};

/// A method under one change, by frame: the pairs of a frame are its draws.
struct SteadyRow {
  SteadyPart part = SteadyPart::gravity;
  std::string change;  // "fx x (1 + 1e-7)"
  std::string method;
  struct OfFrame {
    int frame = 0;
    std::vector<SteadyPair> pairs;  // not empty
  };
  std::vector<OfFrame> frames;
};

/// A recording.
struct SteadyScores {
  std::string recording;
  bool has_poses = false;
  std::vector<SteadyRow> rows;       // by change, then by method
  std::vector<std::string> refused;  // a line for each frame and method that was left out
};

struct SteadyResults {
  std::string command;  // measures the same again, without folders and threads
  report::BuildInfo build;
  planes::WeightsRecord weights;  // empty file: no network was used
  std::vector<SteadyScores> recordings;
};

/// A figure of the table. Without `whole` it is the mean of `part` over a frame's pairs, and of
/// that over frames; with it, the sum of `part` over all pairs by that of `whole`.
struct SteadyFigure {
  const char* name;    // in steady.json
  const char* column;  // of the table
  int digits;
  double scale;  // 100: per cent
  double (*part)(const SteadyPair& pair);
  double (*whole)(const SteadyPair& pair);
  bool (*applies)(SteadyPart part);
};
const std::vector<SteadyFigure>& steady_figures();

struct MeanAndError {
  double mean = 0;
  double error = 0;  // standard error over frames; NaN for fewer than two
};
/// Nothing where the figure does not apply to the row's change, or has nothing to count.
std::optional<MeanAndError> steady_figure(const SteadyFigure& figure, const SteadyRow& row);

Table steady_table(const SteadyResults& results);
std::string steady_json(const SteadyResults& results);  // "planescope.bench.steady/1"
std::string steady_markdown(const SteadyResults& results);

}  // namespace planescope::lab
