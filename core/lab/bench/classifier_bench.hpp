#pragma once

// Everything that `planescope-lab bench classifier` measures, as tables and as JSON.

#include <optional>
#include <string>
#include <vector>

#include "core/lab/bench/frame_bench.hpp"
#include "core/lab/bench/label_bench.hpp"
#include "core/lab/bench/measuring.hpp"
#include "core/lab/bench/speed_bench.hpp"
#include "core/lab/bench/table.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

struct ClassifierBench {
  std::string command;  // as it was typed
  // Names in the tables, and the weights.
  std::vector<std::pair<std::string, planes::WeightsRecord>> networks;

  LabelBenchOptions labels;
  bool accuracy = false, gravity = false;  // which of the label rows' figures are asked for
  std::vector<LabelRow> label_rows;
  std::vector<ChainRow> chain_rows;

  // What depends on time and machine.
  Machine machine;
  SpeedBenchOptions speed_options;
  std::optional<SpeedBench> speed;
  std::vector<FrameRow> frame_rows;
};

/// The same for the same seed and count, on any machine with any number of threads.
std::vector<Table> result_tables(const ClassifierBench& bench);
std::string results_json(const ClassifierBench& bench);

std::vector<Table> timing_tables(const ClassifierBench& bench);
std::string timings_json(const ClassifierBench& bench);

}  // namespace planescope::lab
