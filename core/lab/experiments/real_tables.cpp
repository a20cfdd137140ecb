#include <fmt/format.h>

#include <algorithm>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/measure_real.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/real_results.hpp"
#include "core/model/text.hpp"

namespace planescope::lab {
namespace {

std::string with_deviation(const MeanAndDeviation& spread, int digits) {
  return fixed(spread.mean, digits) + " +- " + fixed(spread.deviation, digits);
}

std::string per_frame(int count, int frames) {
  return fixed(static_cast<double>(count) / frames, 2);
}

std::string frames_of(const HalfSummary& summary) {
  return counted(static_cast<std::size_t>(summary.frames), "frame");
}

std::vector<Table> half_tables(const LabelledScores& scores) {
  std::vector<Table> tables;
  for (const HalfSummary& s : half_summaries(scores)) {
    const std::string title =
        fmt::format("Labelled real frames, half {}: {}", to_string(s.half), frames_of(s));
    if (tables.empty() || tables.back().title != title) {
      Table& table = tables.emplace_back();
      table.title = title;
      table.columns = {"method", "IoU",    "PQ",    "det",    "precision",
                       "recall", "over",   "under", "missed", "noise",
                       "ghosts", "pieces", "alpha", "r_p",    "r_m"};
      if (tables.size() == 1)
        table.note = fmt::format(
            "By pixel; true planes of fewer than {} pixels are not scored. IoU: mean over true "
            "planes, PQ: panoptic quality, both mean +- standard deviation over frames [%]; det: "
            "true planes found with an IoU of at least 0.8; precision, recall: found and true "
            "planes that are correct, sharing 80 % of either [%]; over, under, missed, noise: "
            "planes a frame that fell apart, are several, were not found, are none; ghosts, "
            "pieces: found planes a frame that match no true one with an IoU above 0.5, pieces "
            "those with at least half of themselves on one; alpha: mean angle to the true normals "
            "[deg]; r_p: 100 x planes found / true; r_m: % of true planes' pixels in no plane.",
            kLeastTruePixels);
    }
    const planes::Metrics& m = s.metrics;
    tables.back().rows.push_back(
        {contestant_name(s.method), with_deviation(s.mean_iou, 2), with_deviation(s.pq, 2),
         fmt::format("{} / {}", m.detected_iou80, m.planes_truth),
         fixed(planes::plane_precision(m), 1), fixed(planes::plane_recall(m), 1),
         per_frame(m.over_segmented, s.frames), per_frame(m.under_segmented, s.frames),
         per_frame(m.missed, s.frames), per_frame(m.noise, s.frames), per_frame(m.ghosts, s.frames),
         per_frame(m.pieces, s.frames), fixed(m.alpha_deg, 2), fixed(m.r_p, 1), fixed(m.r_m, 2)});
  }
  return tables;
}

/// Ours against the best of the other methods in each figure: "+1.20 / -0.34 / +1".
std::string difference(const LabelledScores& scores, std::size_t frame) {
  const planes::Metrics& ours = scores.methods[0].of_frames[frame];
  double iou = 0, pq = 0;
  int detected = 0;
  for (const MethodScores& method : scores.methods) {
    if (method.method.method == "ours") continue;
    const planes::Metrics& other = method.of_frames[frame];
    iou = std::max(iou, other.mean_iou);
    pq = std::max(pq, other.pq);
    detected = std::max(detected, other.detected_iou80);
  }
  return fmt::format("{:+.1f} / {:+.1f} / {:+}", ours.mean_iou - iou, ours.pq - pq,
                     ours.detected_iou80 - detected);
}

Table frames_table(const LabelledScores& scores) {
  Table table{"Labelled real frames one by one", "", {"frame", "half"}, {}, 2};
  table.columns.emplace_back("true");
  for (const MethodScores& method : scores.methods)
    if (method.method.setting.empty()) table.columns.push_back(contestant_name(method.method));
  table.columns.emplace_back("against the best other");
  for (std::size_t i = 0; i < scores.frames.size(); ++i) {
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {scores.frames[i].name, to_string(scores.frames[i].half),
           std::to_string(scores.methods[0].of_frames[i].planes_truth)};
    for (const MethodScores& method : scores.methods) {
      if (!method.method.setting.empty()) continue;
      const planes::Metrics& m = method.of_frames[i];
      row.push_back(fmt::format("{:.1f} / {:.1f} / {}", m.mean_iou, m.pq, m.detected_iou80));
    }
    row.push_back(difference(scores, i));
  }
  table.note = fmt::format(
      "true: planes that are scored. Mean IoU [%] / PQ [%] / true planes found with an IoU of at "
      "least 0.8. Last column: {} less the best of the methods that are not ours, each figure by "
      "itself.",
      contestant_name(scores.methods[0].method));
  return table;
}

std::vector<Table> set_tables(const std::vector<SetScores>& sets) {
  std::vector<Table> tables;
  for (const SetSummary& s : set_summaries(sets)) {
    const std::string title =
        fmt::format("{}, {}: {}, {} each", s.set.empty() ? "All depth sets" : s.set, s.errors,
                    counted(static_cast<std::size_t>(s.seeds), "seed"),
                    counted(static_cast<std::size_t>(s.frames), "frame"));
    if (tables.empty() || tables.back().title != title) {
      Table& table = tables.emplace_back();
      table.title = title;
      table.columns = {"method"};
      for (const SeedFigure& figure : seed_figures()) table.columns.emplace_back(figure.column);
      if (tables.size() == 1)
        table.note = fmt::format(
            "The tables that follow have the same columns. By pixel; true planes of fewer than {} "
            "voxels are not scored. Mean +- standard deviation over seeds (the worst seed). IoU: "
            "mean over true planes, PQ: panoptic quality [%]; det: % of true planes found with an "
            "IoU of at least 0.8; noise: planes a frame that are none by 80 % overlap; ghosts, "
            "pieces: found planes a frame that match no true one with an IoU above 0.5, pieces "
            "those with at least half of themselves on one; alpha: mean angle to the true normals "
            "[deg].",
            kMinTruthVoxels);
    }
    std::vector<std::string>& row = tables.back().rows.emplace_back(1, contestant_name(s.method));
    for (std::size_t f = 0; f < s.figures.size(); ++f) {
      const int digits = seed_figures()[f].digits;
      row.push_back(fmt::format("{} ({})", with_deviation(s.figures[f].spread, digits),
                                fixed(s.figures[f].worst, digits)));
    }
  }
  return tables;
}

Table repeat_table(const RepeatScores& scores) {
  Table table;
  table.title =
      fmt::format("From frame to frame: {} of {}",
                  counted(static_cast<std::size_t>(scores.frames), "frame"), scores.recording);
  table.columns = {"method", "planes", "again", "offset",  "normal",  "angles",
                   "within", "sigmas", "floor", "largest", "missing", "one floor"};
  for (const RepeatSummary& s : repeat_summaries(scores))
    table.rows.push_back(
        {contestant_name(s.method), std::to_string(s.planes),
         fixed(percent(s.partners, s.planes), 1), fixed(s.offset_jump_m, 4),
         fixed(s.normal_jump_deg, 3), std::to_string(s.angles), fixed(s.angles_within, 1),
         fixed(s.angle_jump_sigmas, 2), fixed(s.floor_pieces, 2), fixed(s.floor_largest, 1),
         fixed(s.floor_missing, 2), fmt::format("{} / {}", s.frames_of_one_floor, scores.frames)});
  table.note = fmt::format(
      "planes: of at least {0} pixels, in all frames but the last; again: % of them that have a "
      "partner in the next frame, with an IoU of at least {1} by pixel; offset, normal: medians "
      "over partners of how far they jump [m, deg], the camera's movement included. angles: "
      "between two partners that stand 60 degrees and more "
      "to each other, which no movement changes; within: % that changed by no more than 2 sigma of "
      "their certainty; sigmas: root mean square of the changes in sigma. floor: pieces "
      "a frame, planes with at least {0} of the floor's pixels that are at least half of their "
      "own; largest: % of the floor's pixels in planes that lie in its largest piece; missing: % "
      "of them in no plane; one floor: frames whose largest piece has at least {2} %. The floor is "
      "told by the pixels alone: the level that most pixels below the camera are near, refined by "
      "least squares, near being within 3 cm, or 1 cm x (depth / m)^2 where that is more.",
      kLeastRepeatPixels, kPartnerIou, kWholeFloor);
  return table;
}

}  // namespace

std::vector<Table> real_tables(const RealResults& results) {
  std::vector<Table> tables = half_tables(results.labelled);
  if (!results.labelled.frames.empty()) tables.push_back(frames_table(results.labelled));
  for (Table& table : set_tables(results.sets)) tables.push_back(std::move(table));
  if (!results.repeat.methods.empty()) tables.push_back(repeat_table(results.repeat));
  return tables;
}

std::string real_markdown(const RealResults& results) {
  return fmt::format(
      "# Real frames, sets of many seeds, frame to frame\n\n"
      "    {}\n\n"
      "{}. Weights {}.\n\n{}",
      results.command, to_text(results.build), to_text(results.weights),
      joined(real_tables(results), to_markdown));
}

}  // namespace planescope::lab
