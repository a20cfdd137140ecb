#pragma once

// Everything that `planescope-lab bench speed` measures, as tables, as JSON and as a page.

#include <optional>
#include <string>
#include <vector>

#include "core/lab/bench/chain_speed.hpp"
#include "core/lab/bench/command_times.hpp"
#include "core/lab/bench/scaling.hpp"
#include "core/lab/bench/table.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::lab {

/// A recording or set that was measured on.
struct SubjectFacts {
  std::string name;
  int frames = 0, width = 0, height = 0;  // 0 x 0: clouds
};

struct ChainSpeed {
  std::string command;  // as it was typed
  report::BuildInfo build;
  planes::WeightsRecord weights;
  Machine machine;
  Peaks peaks;
  int rounds = 0, threads = 1;
  std::vector<SubjectFacts> subjects;

  // By part; empty where it was not asked for.
  std::vector<StageRow> stages;
  std::vector<DuelRow> duels;  // of part stages
  std::vector<MethodRow> methods;
  std::vector<Scaling> scaling;
  std::vector<StageRow> stage_memory;
  std::vector<MethodRow> method_memory;
  std::vector<CommandRow> commands;
};

Table stage_table(const ChainSpeed& speed);
Table duel_table(const ChainSpeed& speed);
Table method_table(const ChainSpeed& speed);
Table scaling_table(const Scaling& scaling);
std::vector<Table> memory_tables(const ChainSpeed& speed);  // stages, methods
Table command_table(const ChainSpeed& speed);
/// Those of all parts that were measured, in the order of the page.
std::vector<Table> speed_tables(const ChainSpeed& speed);

std::string speed_json(const ChainSpeed& speed);  // schema planescope.bench.speed/1
std::string speed_page(const ChainSpeed& speed);  // HTML

}  // namespace planescope::lab
