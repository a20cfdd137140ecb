// real.json, "planescope.real/1". A frame, a set's seed, a summary stand on one line each, so that
// two runs are easily compared.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/lab/experiments/json_lines.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/real_summary.hpp"
#include "core/model/error.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const planes::Metrics& metrics) {
  Json json;
  planes::visit_values(metrics, [&](const char* name, const auto& value) { json[name] = value; });
  return json;
}

Json json_of(const MeanAndDeviation& spread) {
  return {{"mean", spread.mean}, {"deviation", spread.deviation}};
}

Json frame_line(const LabelledScores& scores, std::size_t frame) {
  const LabelledName& name = scores.frames[frame];
  Json json = {{"name", name.name},
               {"half", to_string(name.half)},
               {"recording", name.recording},
               {"frame", name.frame}};
  for (const MethodScores& method : scores.methods)
    json["scores"][contestant_name(method.method)] = json_of(method.of_frames[frame]);
  return json;
}

Json line_of(const HalfSummary& s) {
  return {{"half", to_string(s.half)},
          {"method", contestant_name(s.method)},
          {"frames", s.frames},
          {"mean_iou", json_of(s.mean_iou)},
          {"pq", json_of(s.pq)},
          {"precision", planes::plane_precision(s.metrics)},
          {"recall", planes::plane_recall(s.metrics)},
          {"metrics", json_of(s.metrics)}};
}

Json line_of(const SetScores& set) {
  Json json = {{"set", set.frames.set}, {"errors", set.frames.errors}, {"seed", set.frames.seed}};
  for (const MethodScores& method : set.methods)
    for (const planes::Metrics& metrics : method.of_frames)
      json["scores"][contestant_name(method.method)].push_back(json_of(metrics));
  return json;
}

Json line_of(const SetSummary& s) {
  Json json = {{"set", s.set.empty() ? "all" : s.set},
               {"errors", s.errors},
               {"method", contestant_name(s.method)},
               {"seeds", s.seeds},
               {"frames", s.frames}};
  for (std::size_t f = 0; f < s.figures.size(); ++f) {
    Json& figure = json[seed_figures()[f].name] = json_of(s.figures[f].spread);
    figure["worst"] = s.figures[f].worst;
  }
  return json;
}

Json line_of(const RepeatScores::OfMethod& method) {
  Json json = {{"method", contestant_name(method.method)},
               {"neighbours", Json::array()},
               {"floor", Json::array()}};
  for (const Neighbours& n : method.neighbours)
    json["neighbours"].push_back({{"planes", n.planes},
                                  {"partners", n.partners},
                                  {"offset_jumps_m", n.offset_jumps_m},
                                  {"normal_jumps_deg", n.normal_jumps_deg}});
  for (const FloorPieces& f : method.floor)
    json["floor"].push_back({{"pixels", f.pixels},
                             {"pieces", f.pieces},
                             {"largest_percent", f.largest},
                             {"missing_percent", f.missing}});
  return json;
}

Json line_of(const RepeatSummary& s) {
  return {{"method", contestant_name(s.method)},
          {"planes", s.planes},
          {"partners", s.partners},
          {"offset_jump_m", s.offset_jump_m},
          {"normal_jump_deg", s.normal_jump_deg},
          {"floor_pieces", s.floor_pieces},
          {"floor_largest_percent", s.floor_largest},
          {"floor_missing_percent", s.floor_missing},
          {"frames_of_one_floor", s.frames_of_one_floor}};
}

template <typename Values>
std::vector<std::string> lines_of(const Values& values) {
  std::vector<std::string> lines;
  for (const auto& value : values) lines.push_back(json_line(line_of(value)));
  return lines;
}

}  // namespace

const char* to_string(Half half) { return half == Half::tuning ? "tuning" : "printed"; }

Half parse_half(const std::string& text) {
  for (const Half half : {Half::tuning, Half::printed})
    if (text == to_string(half)) return half;
  throw Error("'" + text + "' is not a half, expected tuning or printed");
}

std::string real_json(const RealResults& results) {
  std::vector<std::string> frames;
  for (std::size_t i = 0; i < results.labelled.frames.size(); ++i)
    frames.push_back(json_line(frame_line(results.labelled, i)));
  Json facts = run_json("planescope.real/1", results.command, results.build, results.weights);
  if (!results.repeat.methods.empty())
    facts["repeated"] = {{"recording", results.repeat.recording},
                         {"frames", results.repeat.frames}};
  JsonLines json(facts);
  json.add("halves", lines_of(half_summaries(results.labelled)));
  json.add("frames", frames);
  json.add("over_seeds", lines_of(set_summaries(results.sets)));
  json.add("sets", lines_of(results.sets));
  json.add("repeat", lines_of(repeat_summaries(results.repeat)));
  json.add("repeat_frames", lines_of(results.repeat.methods));
  return std::move(json).text();
}

}  // namespace planescope::lab
