#include "core/lab/experiments/steady_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/lab/bench/result_json.hpp"
#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

const std::vector<SteadyPart>& steady_parts() {
  static const std::vector<SteadyPart> parts = {SteadyPart::gravity, SteadyPart::focal,
                                                SteadyPart::rounded, SteadyPart::dither,
                                                SteadyPart::next};
  return parts;
}

const char* to_string(SteadyPart part) {
  switch (part) {
    case SteadyPart::gravity:
      return "gravity";
    case SteadyPart::focal:
      return "focal";
    case SteadyPart::rounded:
      return "rounded";
    case SteadyPart::dither:
      return "dither";
    case SteadyPart::next:
      return "next";
  }
  return "?";
}

namespace {

bool always(SteadyPart) { return true; }
bool is_next(SteadyPart part) { return part == SteadyPart::next; }
/// Of changes so small that no plane should change at all.
bool is_tiny(SteadyPart part) { return part != SteadyPart::dither && part != SteadyPart::next; }

double share_lost(const KeptPlanes& kept) {
  return static_cast<double>(kept.lost()) / std::max(1, kept.planes);
}

}  // namespace

const std::vector<SteadyFigure>& steady_figures() {
  using Pair = const SteadyPair&;
  static const std::vector<SteadyFigure> figures = {
      {"planes", "planes", 1, 1, [](Pair p) { return double(p.planes.all.planes); }, nullptr,
       always},
      {"changed", "changed", 2, 1, [](Pair p) { return double(p.planes.changed); }, nullptr,
       is_tiny},
      {"count_difference", "count", 2, 1, [](Pair p) { return double(p.count_difference); },
       nullptr, is_tiny},
      {"label_changes", "h/v", 3, 1, [](Pair p) { return double(p.label_changes); }, nullptr,
       is_tiny},
      {"label_changes_deg", "from limit", 1, 1, [](Pair p) { return p.label_changes_deg; },
       [](Pair p) { return double(p.label_changes); }, is_tiny},
      {"report_errors", "errors", 2, 1, [](Pair p) { return double(p.report_errors); }, nullptr,
       is_tiny},
      {"self_pq", "self-PQ", 3, 1, [](Pair p) { return p.planes.self_pq(); }, nullptr, always},
      {"lost_percent", "lost", 1, 100, [](Pair p) { return share_lost(p.planes.all); }, nullptr,
       always},
      {"big_lost_percent", "big lost", 1, 100, [](Pair p) { return double(p.planes.all.big_lost); },
       [](Pair p) { return double(p.planes.all.big); }, always},
      {"big", "big", 2, 1, [](Pair p) { return double(p.planes.all.big); }, nullptr, always},
      {"decided_pq", "decided PQ", 3, 1, [](Pair p) { return p.planes.decided_pq(); }, nullptr,
       is_next},
      {"decided_lost_percent", "decided lost", 1, 100,
       [](Pair p) { return share_lost(p.planes.decided); }, nullptr, is_next},
      {"decided_big_lost_percent", "decided big lost", 1, 100,
       [](Pair p) { return double(p.planes.decided.big_lost); },
       [](Pair p) { return double(p.planes.decided.big); }, is_next},
      {"decided_big", "decided big", 2, 1, [](Pair p) { return double(p.planes.decided.big); },
       nullptr, is_next},
      {"undecided_big_percent", "undecided", 1, 100,
       [](Pair p) { return double(p.planes.all.big - p.planes.decided.big); },
       [](Pair p) { return double(p.planes.all.big); }, is_next}};
  return figures;
}

namespace {

/// Of a frame: the sums over its pairs. Without `whole`, that is the number of pairs.
struct FrameSums {
  double part = 0, whole = 0;
};

FrameSums sums_of(const SteadyFigure& figure, const SteadyRow::OfFrame& frame) {
  FrameSums sums;
  for (const SteadyPair& pair : frame.pairs) {
    sums.part += figure.part(pair);
    sums.whole += figure.whole ? figure.whole(pair) : 1;
  }
  return sums;
}

}  // namespace

std::optional<MeanAndError> steady_figure(const SteadyFigure& figure, const SteadyRow& row) {
  if (!figure.applies(row.part)) return std::nullopt;
  std::vector<FrameSums> frames;
  FrameSums all;
  for (const SteadyRow::OfFrame& frame : row.frames) {
    FrameSums sums = sums_of(figure, frame);
    if (!figure.whole) sums = {sums.part / sums.whole, 1};  // each frame counts the same
    all.part += sums.part;
    all.whole += sums.whole;
    frames.push_back(sums);
  }
  if (!(all.whole > 0)) return std::nullopt;
  const double ratio = all.part / all.whole;
  // Of a ratio of sums (Cochran 1977, Sec. 2.11); where all weights are 1, of a mean.
  double squares = 0;
  for (const FrameSums& sums : frames) squares += std::pow(sums.part - ratio * sums.whole, 2);
  const auto n = static_cast<double>(frames.size());
  const double error = std::sqrt(squares * n / (n - 1)) / all.whole;  // NaN for one frame
  return MeanAndError{figure.scale * ratio, figure.scale * error};
}

namespace {

constexpr const char* kSteadyNote =
    "n: frames, each with all draws of its change, or pairs of frames. Mean +- standard error over "
    "frames. planes: of a frame, with at least one compared pixel; changed: planes without a plane "
    "of IoU >= {:.2f} after the change; count: difference in the number of planes; h/v: partners "
    "with different labels; from limit: angle between their normals and the 45 degree limit [deg]; "
    "errors: those of `planescope report --baseline` with its built-in rules. A plane's partner is "
    "the plane of the other image with the greatest IoU, if above {}. self-PQ: sum of IoU over "
    "planes with a partner, by the mean number of planes of both images; lost: % of planes without "
    "a partner; big: planes a frame with at least {} compared pixels; big lost: % of all of them "
    "without a partner. decided: the same of the first frame's decided planes, their PQ by their "
    "number; undecided: % of big planes that are not decided.";

std::string steady_cell(const std::optional<MeanAndError>& value, int digits) {
  if (!value) return "-";
  if (std::isnan(value->error)) return fixed(value->mean, digits);
  return fixed(value->mean, digits) + " +- " + fixed(value->error, digits);
}

}  // namespace

Table steady_table(const SteadyResults& results) {
  Table table{"Steadiness", "", {"recording", "change", "method", "n"}, {}, 3};
  std::vector<SteadyFigure> shown;  // those with a value in any row
  for (const SteadyFigure& figure : steady_figures()) {
    const auto has_value = [&](const SteadyRow& row) { return bool(steady_figure(figure, row)); };
    if (std::ranges::any_of(results.recordings, [&](const SteadyScores& scores) {
          return std::ranges::any_of(scores.rows, has_value);
        }))
      shown.push_back(figure);
  }
  for (const SteadyFigure& figure : shown) table.columns.emplace_back(figure.column);
  for (const SteadyScores& scores : results.recordings)
    for (const SteadyRow& row : scores.rows) {
      std::vector<std::string>& cells = table.rows.emplace_back();
      cells = {scores.recording, row.change, row.method, std::to_string(row.frames.size())};
      for (const SteadyFigure& figure : shown)
        cells.push_back(steady_cell(steady_figure(figure, row), figure.digits));
    }
  table.note =
      fmt::format(fmt::runtime(kSteadyNote), kSamePlaneIou, kSteadyPartnerIou, kBigPlanePixels);
  return table;
}

namespace {

using Json = nlohmann::ordered_json;

Json steady_row_json(const SteadyScores& scores, const SteadyRow& row) {
  return {{"recording", scores.recording},
          {"part", to_string(row.part)},
          {"change", row.change},
          {"method", row.method}};
}

std::string steady_summary_line(const SteadyScores& scores, const SteadyRow& row) {
  Json json = steady_row_json(scores, row);
  json["n"] = row.frames.size();
  for (const SteadyFigure& figure : steady_figures()) {
    if (!figure.applies(row.part)) continue;
    const std::optional<MeanAndError> value = steady_figure(figure, row);
    json[figure.name] = value ? Json{{"mean", value->mean}, {"error", value->error}} : Json();
  }
  return json_line(json);
}

/// Of each frame, by figure: the sum over its pairs; where it is a share, that of the whole, too.
std::string steady_frames_line(const SteadyScores& scores, const SteadyRow& row) {
  Json json = steady_row_json(scores, row);
  json["frames"] = Json::array();
  for (const SteadyRow::OfFrame& frame : row.frames) {
    Json& of_frame = json["frames"].emplace_back();
    of_frame["frame"] = frame.frame;
    of_frame["pairs"] = frame.pairs.size();
    for (const SteadyFigure& figure : steady_figures()) {
      if (!figure.applies(row.part)) continue;
      const FrameSums sums = sums_of(figure, frame);
      of_frame[figure.name] = figure.whole ? Json::array({sums.part, sums.whole}) : Json(sums.part);
    }
  }
  return json_line(json);
}

}  // namespace

std::string steady_json(const SteadyResults& results) {
  Json facts =
      run_json("planescope.bench.steady/1", results.command, results.build, results.weights);
  std::vector<std::string> rows, frames;
  for (const SteadyScores& scores : results.recordings) {
    facts["recordings"].push_back({{"recording", scores.recording},
                                   {"poses", scores.has_poses},
                                   {"refused", scores.refused}});
    for (const SteadyRow& row : scores.rows) {
      rows.push_back(steady_summary_line(scores, row));
      frames.push_back(steady_frames_line(scores, row));
    }
  }
  JsonLines json(facts);
  json.add("rows", rows);
  json.add("frames", frames);
  return std::move(json).text();
}

std::string steady_markdown(const SteadyResults& results) {
  const std::string weights =
      results.weights.file.empty() ? "" : fmt::format(" Weights {}.", to_text(results.weights));
  std::string refused;
  for (const SteadyScores& scores : results.recordings)
    for (const std::string& line : scores.refused)
      refused += fmt::format("- {}: left out, {}\n", scores.recording, line);
  return fmt::format("# Steadiness\n\n    {}\n\n{}.{}\n\n{}{}", results.command,
                     to_text(results.build), weights, to_markdown(steady_table(results)),
                     refused.empty() ? "" : "\n" + refused);
}

}  // namespace planescope::lab
