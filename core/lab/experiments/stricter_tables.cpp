// What tells methods apart (SegComp, EVOPS and panoptic conventions), for all of them on all sets.

#include <algorithm>
#include <optional>
#include <span>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"

namespace planescope::lab {
namespace {

/// Several sets as one: means over all their frames, counts added up. nullopt where one of them was
/// not measured.
std::optional<Cell> joined_cell(const PaperResults& results, std::span<const CellKey> keys) {
  if (keys.size() == 1) {  // to the same bits
    const Cell* cell = results.find(keys[0]);
    return cell ? std::optional(*cell) : std::nullopt;
  }
  std::vector<planes::Metrics> of_frames;
  Cell joined;
  planes::Metrics sums;
  for (const CellKey& key : keys) {
    const Cell* cell = results.find(key);
    if (!cell) return std::nullopt;
    of_frames.insert(of_frames.end(), static_cast<std::size_t>(cell->frames), cell->metrics);
    const std::vector<planes::Metrics> both = {sums, cell->metrics};
    sums = planes::mean_of(both);  // its counts are sums
    joined.frames += cell->frames;
  }
  joined.metrics = planes::mean_of(of_frames);
  for (const auto count : {&planes::Metrics::planes_truth, &planes::Metrics::planes_found,
                           &planes::Metrics::detected_iou80, &planes::Metrics::correct,
                           &planes::Metrics::over_segmented, &planes::Metrics::under_segmented,
                           &planes::Metrics::missed, &planes::Metrics::noise,
                           &planes::Metrics::pieces, &planes::Metrics::ghosts})
    joined.metrics.*count = sums.*count;
  joined.metrics.points = sums.points;
  joined.metrics.r_p = percent(sums.planes_found, sums.planes_truth);
  return joined;
}

const std::vector<std::string> kColumns = {"alpha", "r_p",  "r_m",  "points", "IoU",
                                           "PQ",    "det",  "over", "under",  "missed",
                                           "noise", "edge", "inner"};
constexpr const char* kColumnNote =
    "The columns of the tables that follow. alpha: mean angle to the true normals [deg]; r_p: 100 "
    "x planes found / true; r_m: % of points "
    "in no plane; points: % in the plane that stands for theirs; IoU: mean over true planes, %; "
    "PQ: "
    "panoptic quality, %; det: % of true planes found with an IoU of at least 0.8; over, under, "
    "missed, noise: % of true planes that fell apart, found planes that are several, true planes "
    "not found, found planes that are none, each by the number of true planes; edge, inner: % of "
    "labels that are right within 2 cm of the other label, and elsewhere.";

std::vector<std::string> figures(const Cell& cell) {
  const planes::Metrics& m = cell.metrics;
  std::vector<std::string> texts = {fixed(m.alpha_deg, 3), fixed(m.r_p, 1),
                                    fixed(m.r_m, 2),       fixed(m.point_accuracy, 2),
                                    fixed(m.mean_iou, 2),  fixed(m.pq, 2)};
  for (const int count : {m.detected_iou80, m.over_segmented, m.under_segmented, m.missed, m.noise})
    texts.push_back(fixed(percent(count, m.planes_truth), 1));
  const bool labels =
      cell.key.method == "ours" && cell.key.classifier != "none" && cell.key.classifier != "truth";
  for (const double value : {m.label_accuracy_edge, m.label_accuracy_inner})
    texts.push_back(labels && value > 0 ? fixed(value, 2) : "-");
  return texts;
}

Table table_of_figures(std::string title, const char* name) {
  Table table{std::move(title), "", {name}, {}, 1};
  table.columns.insert(table.columns.end(), kColumns.begin(), kColumns.end());
  return table;
}

void add_row(Table& table, const std::string& name, const Cell& cell) {
  std::vector<std::string>& row = table.rows.emplace_back(1, name);
  for (std::string& text : figures(cell)) row.push_back(std::move(text));
}

/// Frames that are scored together, and what they are called.
struct Subject {
  std::string title, meaning;
  std::vector<CellKey> frames;
};

std::vector<CellKey> each_with(const std::vector<CellKey>& frames, const CellKey& contestant) {
  std::vector<CellKey> keys;
  for (const CellKey& key : frames) keys.push_back(with_method_of(key, contestant));
  return keys;
}

std::string meaning_of(const std::string& set) {
  if (set == kRealLabelled) return "the labelled frame of ICL-NUIM's living room, within 4 m";
  return find_evaluation_set(set).meaning;
}

std::vector<Subject> subjects(const PaperResults& results) {
  std::vector<Subject> all;
  for (const Cell& cell : results.cells) {
    const CellKey& key = cell.key;
    if (key.seed == results.tuning_seed && key.seed != results.seed) continue;
    if (std::ranges::any_of(all, [&](const Subject& s) { return same_frames(s.frames[0], key); }))
      continue;
    all.push_back({frames_name(key), meaning_of(key.set), {key}});
  }
  Subject depth{"all depth sets, d435", "the three sets of D435-like depth frames together", {}};
  for (const std::string& set : depth_sets())
    depth.frames.push_back(depth_of(set, results.seed, "d435"));
  all.push_back(depth);
  return all;
}

/// Of every contestant but those of the ablation, in the order in which they were planned.
std::vector<CellKey> contestants(const PaperResults& results, const CellKey& frames) {
  std::vector<CellKey> keys;
  for (const Cell& cell : results.cells)
    if (same_frames(cell.key, frames) && (cell.key.method != "ours" || cell.key.setting.empty()))
      keys.push_back(cell.key);
  return keys;
}

Table methods_table(const PaperResults& results, const Subject& subject) {
  Table table = table_of_figures(subject.title, "method");
  int frames = 0;
  for (const CellKey& key : contestants(results, subject.frames[0])) {
    std::optional<Cell> cell = joined_cell(results, each_with(subject.frames, key));
    if (!cell) continue;
    cell->key = key;
    frames = cell->frames;
    add_row(table, contestant_name(key), *cell);
  }
  table.note = fmt::format(
      "{}; {} frame{}{}, scored by {}.", subject.meaning, frames, frames == 1 ? "" : "s",
      subject.frames[0].seed != 0 ? fmt::format(", seed {}", subject.frames[0].seed) : "",
      subject.frames[0].points > 0 ? "point" : "voxel");
  return table;
}

/// One figure of every method on every set.
Table overview(const PaperResults& results) {
  Table table{"Mean IoU of every method on every set", kColumnNote, {"frames"}, {}, 1};
  std::vector<CellKey> methods;
  for (const Cell& cell : results.cells) {
    const CellKey method = with_method_of({}, cell.key);
    const bool ours = method.method == "ours";
    if (ours &&
        (method.profile != "refined" || method.classifier == "none" || !method.setting.empty()))
      continue;
    if (std::ranges::find(methods, method) == methods.end()) methods.push_back(method);
  }
  for (const CellKey& method : methods) table.columns.push_back(contestant_name(method));
  for (const Subject& subject : subjects(results)) {
    std::vector<std::string> row = {subject.title};
    bool any = false;
    for (const CellKey& method : methods) {
      const std::optional<Cell> cell = joined_cell(results, each_with(subject.frames, method));
      row.push_back(cell ? fixed(cell->metrics.mean_iou, 2) : "-");
      any = any || cell;
    }
    if (any) table.rows.push_back(std::move(row));
  }
  return table;
}

std::optional<Table> ablation(const PaperResults& results,
                              const std::string& title,
                              const std::vector<CellKey>& frames) {
  Table table =
      table_of_figures("Profile refined without terms of its objective, " + title, "without");
  table.note = "Labels by gcn.";
  const auto add = [&](const std::string& name, const CellKey& contestant) {
    std::optional<Cell> cell = joined_cell(results, each_with(frames, contestant));
    if (!cell) return;
    cell->key = contestant;
    add_row(table, name, *cell);
  };
  add("nothing left out", with_ours({}, "refined", "gcn"));
  for (const std::string& term : objective_terms(!frames.front().errors.empty()))
    add(term, with_ours({}, "refined", "gcn", without(term)));
  return table.rows.size() > 1 ? std::optional(std::move(table)) : std::nullopt;
}

}  // namespace

std::vector<Table> stricter_tables(const PaperResults& results) {
  std::vector<Table> tables;
  if (results.cells.empty()) return tables;
  tables.push_back(overview(results));
  for (const Subject& subject : subjects(results))
    if (Table table = methods_table(results, subject); !table.rows.empty())
      tables.push_back(std::move(table));
  std::vector<CellKey> depth;
  for (const std::string& set : depth_sets()) depth.push_back(depth_of(set, results.seed, "d435"));
  for (auto& table :
       {ablation(results, "stairs, 8192 points, 0.3 cm", {stairs_of(results.seed, 8192, 0.3)}),
        ablation(results, "all depth sets, d435", depth)})
    if (table) tables.push_back(*table);
  return tables;
}

}  // namespace planescope::lab
