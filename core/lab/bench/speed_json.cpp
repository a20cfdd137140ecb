// speed.json of `planescope-lab bench speed`.

#include <nlohmann/json.hpp>

#include "core/lab/bench/result_json.hpp"
#include "core/lab/bench/speed_page.hpp"

namespace planescope::lab {
namespace {

using SpeedJson = nlohmann::ordered_json;

SpeedJson times_json(const Times& times) {
  return {{"median", times.median}, {"least", times.least}, {"greatest", times.greatest}};
}

/// null: was not counted.
SpeedJson allocations_json(const std::optional<Allocations>& allocations) {
  if (!allocations) return nullptr;
  return {{"calls", allocations->calls}, {"bytes", allocations->bytes}};
}

SpeedJson stage_json(const StageRow& row) {
  return {{"recording", row.recording},
          {"stage", row.stage},
          {"ms", times_json(row.ms)},
          {"bytes", row.work.bytes},
          {"flops", row.work.flops},
          {"floor_ms", row.floor.ms},
          {"bound_by", row.floor.by_bytes ? "bytes" : "flops"},
          {"ratio", row.ratio}};
}

SpeedJson duel_json(const DuelRow& row) {
  return {{"recording", row.recording},
          {"stage", row.stage},
          {"rival", row.rival},
          {"ours_ms", times_json(row.ours_ms)},
          {"rival_ms", times_json(row.rival_ms)},
          {"ratio", row.ratio}};
}

SpeedJson method_json(const MethodRow& row) {
  return {{"recording", row.recording},
          {"method", row.method},
          {"ms", times_json(row.ms)},
          {"ratio", row.ratio},
          {"planes", row.planes}};
}

SpeedJson scaling_json(const Scaling& scaling) {
  SpeedJson curves = SpeedJson::array();
  for (const ScalingCurve& curve : scaling.curves)
    // An exponent that is NaN becomes null.
    curves.push_back({{"name", curve.name}, {"ms", curve.ms}, {"exponent", curve.exponent}});
  return {{"id", scaling.id},
          {"x_name", scaling.x_name},
          {"clock", to_string(scaling.clock)},
          {"x", scaling.x},
          {"curves", curves}};
}

SpeedJson command_json(const CommandRow& row) {
  return {{"command", row.name},
          {"wall_ms", times_json(row.wall_ms)},
          {"cpu_ms", times_json(row.cpu_ms)},
          {"peak_mib", row.peak_mib}};
}

template <typename Rows, typename ToJson>
std::vector<std::string> lines_of(const Rows& rows, const ToJson& to_json) {
  std::vector<std::string> lines;
  for (const auto& row : rows) lines.push_back(json_line(to_json(row)));
  return lines;
}

}  // namespace

std::string speed_json(const ChainSpeed& speed) {
  SpeedJson facts = run_json("planescope.bench.speed/1", speed.command, speed.build, speed.weights);
  facts["machine"] = machine_json(speed.machine);
  if (!speed.stages.empty()) {
    facts["bytes_per_s"] = speed.peaks.bytes_per_s;
    facts["flops_per_s"] = speed.peaks.flops_per_s;
  }
  facts["rounds"] = speed.rounds;
  facts["threads"] = speed.threads;
  JsonLines json(facts);
  json.add("recordings", lines_of(speed.subjects, [](const SubjectFacts& subject) {
             return SpeedJson{{"name", subject.name},
                              {"frames", subject.frames},
                              {"width", subject.width},
                              {"height", subject.height}};
           }));
  json.add("stages", lines_of(speed.stages, stage_json));
  json.add("stage_rivals", lines_of(speed.duels, duel_json));
  json.add("frames", lines_of(speed.methods, method_json));
  json.add("scaling", lines_of(speed.scaling, scaling_json));
  json.add("stage_memory", lines_of(speed.stage_memory, [](const StageRow& row) {
             return SpeedJson{{"recording", row.recording},
                              {"stage", row.stage},
                              {"allocations", allocations_json(row.allocations)}};
           }));
  json.add("frame_memory", lines_of(speed.method_memory, [](const MethodRow& row) {
             return SpeedJson{{"recording", row.recording},
                              {"method", row.method},
                              {"allocations", allocations_json(row.allocations)},
                              {"peak_mib", row.peak_mib}};
           }));
  json.add("commands", lines_of(speed.commands, command_json));
  return std::move(json).text();
}

}  // namespace planescope::lab
