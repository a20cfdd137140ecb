#include "core/lab/experiments/real_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/lab/bench/result_json.hpp"
#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/model/error.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {

// ---- Sums ----

namespace {

double each(int count, int frames) { return static_cast<double>(count) / frames; }

HalfSummary half_summary(Half half,
                         const CellKey& method,
                         std::span<const planes::Metrics> frames) {
  std::vector<double> iou, pq;
  for (const planes::Metrics& m : frames) {
    iou.push_back(m.mean_iou);
    pq.push_back(m.pq);
  }
  return {half,
          method,
          static_cast<int>(frames.size()),
          mean_and_deviation(iou),
          mean_and_deviation(pq),
          planes::mean_of(frames)};
}

/// `of_seeds`: what a method scored on the frames of each seed.
SetSummary set_summary(const std::vector<std::vector<planes::Metrics>>& of_seeds) {
  SetSummary summary;
  summary.seeds = static_cast<int>(of_seeds.size());
  summary.frames = static_cast<int>(of_seeds[0].size());
  for (const SeedFigure& figure : seed_figures()) {
    std::vector<double> values;
    for (const std::vector<planes::Metrics>& frames : of_seeds)
      values.push_back(figure.value(planes::mean_of(frames), static_cast<int>(frames.size())));
    summary.figures.push_back({mean_and_deviation(values), figure.more_is_better
                                                               ? std::ranges::min(values)
                                                               : std::ranges::max(values)});
  }
  return summary;
}

/// What a method scored on sets with these errors, by seed; an empty name means all sets.
std::vector<std::vector<planes::Metrics>> of_seeds(const std::vector<SetScores>& sets,
                                                   const std::string& name,
                                                   const std::string& errors,
                                                   std::size_t method) {
  std::vector<std::uint64_t> seeds;
  std::vector<std::vector<planes::Metrics>> scores;
  for (const SetScores& set : sets) {
    if (set.frames.errors != errors || (!name.empty() && set.frames.set != name)) continue;
    const auto at = std::ranges::find(seeds, set.frames.seed) - seeds.begin();
    if (at == std::ssize(seeds)) {
      seeds.push_back(set.frames.seed);
      scores.emplace_back();
    }
    const std::vector<planes::Metrics>& more = set.methods[method].of_frames;
    scores[static_cast<std::size_t>(at)].insert(scores[static_cast<std::size_t>(at)].end(),
                                                more.begin(), more.end());
  }
  return scores;
}

double median_or_0(const std::vector<double>& values) {
  return values.empty() ? 0 : median(values);
}

}  // namespace

std::vector<HalfSummary> half_summaries(const LabelledScores& scores) {
  std::vector<HalfSummary> summaries;
  for (const Half half : {Half::tuning, Half::printed})
    for (const MethodScores& method : scores.methods) {
      std::vector<planes::Metrics> frames;
      for (std::size_t i = 0; i < scores.frames.size(); ++i)
        if (scores.frames[i].half == half) frames.push_back(method.of_frames[i]);
      if (!frames.empty()) summaries.push_back(half_summary(half, method.method, frames));
    }
  return summaries;
}

const std::vector<SeedFigure>& seed_figures() {
  static const std::vector<SeedFigure> figures = {
      {"mean_iou", "IoU", 2, true, [](const planes::Metrics& m, int) { return m.mean_iou; }},
      {"pq", "PQ", 2, true, [](const planes::Metrics& m, int) { return m.pq; }},
      {"detected_percent", "det", 1, true,
       [](const planes::Metrics& m, int) { return percent(m.detected_iou80, m.planes_truth); }},
      {"noise_per_frame", "noise", 2, false,
       [](const planes::Metrics& m, int frames) { return each(m.noise, frames); }},
      {"ghosts_per_frame", "ghosts", 2, false,
       [](const planes::Metrics& m, int frames) { return each(m.ghosts, frames); }},
      {"pieces_per_frame", "pieces", 2, false,
       [](const planes::Metrics& m, int frames) { return each(m.pieces, frames); }},
      {"alpha_deg", "alpha", 3, false, [](const planes::Metrics& m, int) { return m.alpha_deg; }}};
  return figures;
}

std::vector<SetSummary> set_summaries(const std::vector<SetScores>& sets) {
  std::vector<std::string> names, errors;
  for (const SetScores& set : sets) {
    if (std::ranges::find(names, set.frames.set) == names.end()) names.push_back(set.frames.set);
    if (std::ranges::find(errors, set.frames.errors) == errors.end())
      errors.push_back(set.frames.errors);
  }
  if (!names.empty()) names.emplace_back();  // all
  std::vector<SetSummary> summaries;
  for (const std::string& name : names)
    for (const std::string& error : errors)
      for (std::size_t m = 0; m < sets[0].methods.size(); ++m) {
        SetSummary& summary = summaries.emplace_back(set_summary(of_seeds(sets, name, error, m)));
        summary.set = name;
        summary.errors = error;
        summary.method = sets[0].methods[m].method;
      }
  return summaries;
}

std::vector<RepeatSummary> repeat_summaries(const RepeatScores& scores) {
  std::vector<RepeatSummary> summaries;
  for (const RepeatScores::OfMethod& method : scores.methods) {
    RepeatSummary& summary = summaries.emplace_back();
    summary.method = method.method;
    std::vector<double> offsets, normals;
    int within = 0;
    double squares = 0;
    for (const Neighbours& n : method.neighbours) {
      summary.planes += n.planes;
      summary.partners += n.partners;
      offsets.insert(offsets.end(), n.offset_jumps_m.begin(), n.offset_jumps_m.end());
      normals.insert(normals.end(), n.normal_jumps_deg.begin(), n.normal_jumps_deg.end());
      for (const double sigmas : n.angle_jumps_sigmas) {
        ++summary.angles;
        within += std::abs(sigmas) <= 2;
        squares += sigmas * sigmas;
      }
    }
    summary.angles_within = percent(within, summary.angles);
    if (summary.angles > 0) summary.angle_jump_sigmas = std::sqrt(squares / summary.angles);
    summary.offset_jump_m = median_or_0(offsets);
    summary.normal_jump_deg = median_or_0(normals);
    for (const FloorPieces& floor : method.floor) {
      summary.floor_pieces += each(floor.pieces, scores.frames);
      summary.floor_largest += floor.largest / scores.frames;
      summary.floor_missing += floor.missing / scores.frames;
      summary.frames_of_one_floor += floor.largest >= kWholeFloor;
    }
  }
  return summaries;
}

// ---- real.json ----

// real.json, "planescope.real/1". A frame, a set's seed, a summary stand on one line each, so that
// two runs are easily compared.

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
          {"angles", s.angles},
          {"angles_within_percent", s.angles_within},
          {"angle_jump_sigmas", s.angle_jump_sigmas},
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
