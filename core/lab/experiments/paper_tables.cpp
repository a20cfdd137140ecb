// Tables I, III, IV and V: the printed value first, then every reading of the text.

#include "core/lab/experiments/paper_tables.hpp"

#include <algorithm>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/printed.hpp"

namespace planescope::lab {

// ---- What was found ----

namespace {

/// The paper's three measures.
struct Three {
  double alpha_deg = 0, r_p = 0, r_m = 0;
  int digits_r_p = 1;  // the paper prints none
};
using Row = std::vector<std::optional<Three>>;  // by column of the paper's table

/// One of the paper's tables: its columns are conditions, under each of the three measures.
class Conditions {
 public:
  Conditions(const PaperResults& results, std::string table, std::vector<CellKey> frames)
      : results_(results), number_(std::move(table)), frames_(std::move(frames)) {}

  Row printed(const std::string& method, bool with_labels) const {
    Row row(frames_.size());
    for (std::size_t i = 0; i < frames_.size(); ++i)
      for (const PrintedCell& cell : printed_cells())
        if (cell.table == number_ && cell.method == method && cell.with_labels == with_labels &&
            cell.points == frames_[i].points && cell.noise_cm == frames_[i].noise_cm)
          row[i] = Three{cell.alpha_deg, cell.r_p, cell.r_m, 0};
    return row;
  }
  Row measured(const CellKey& contestant) const {
    Row row;
    for (const CellKey& frames : frames_) {
      const Cell* cell = results_.find(with_method_of(frames, contestant));
      row.push_back(
          cell ? std::optional(Three{cell->metrics.alpha_deg, cell->metrics.r_p, cell->metrics.r_m})
               : std::nullopt);
    }
    return row;
  }
  std::string frames_text() const {
    for (const CellKey& frames : frames_)
      for (const Cell& cell : results_.cells)
        if (same_frames(cell.key, frames))
          return fmt::format("{} stairs, seed {}", cell.frames, frames.seed);
    return "";
  }

 private:
  const PaperResults& results_;
  std::string number_;
  std::vector<CellKey> frames_;
};

class PaperTable {
 public:
  PaperTable(std::string title,
             std::vector<std::string> names,
             const std::vector<std::string>& conditions)
      : conditions_(conditions.size()) {
    table_.title = std::move(title);
    table_.names = names.size();
    table_.columns = std::move(names);
    for (const char* measure : {"alpha", "r_p", "r_m"})
      for (const std::string& condition : conditions)
        table_.columns.push_back(fmt::format("{} {}", measure, condition));
  }
  void add_printed(std::vector<std::string> names, const Row& row) { add(std::move(names), row); }
  void add_measured(std::vector<std::string> names, const Row& row) {
    if (std::ranges::none_of(row, [](const auto& three) { return three.has_value(); })) return;
    add(std::move(names), row);
    measured_ = true;
  }
  /// nullopt where nothing of it was measured.
  std::optional<Table> table(const std::string& note) && {
    table_.note = note;
    return measured_ ? std::optional(std::move(table_)) : std::nullopt;
  }

 private:
  void add(std::vector<std::string> cells, const Row& row) {
    for (int measure = 0; measure < 3; ++measure)
      for (std::size_t i = 0; i < conditions_; ++i) {
        if (!row[i]) {
          cells.push_back("-");
          continue;
        }
        const Three& three = *row[i];
        cells.push_back(measure == 0   ? fixed(three.alpha_deg, 3)
                        : measure == 1 ? fixed(three.r_p, three.digits_r_p)
                                       : fixed(three.r_m, 2));
      }
    table_.rows.push_back(std::move(cells));
  }

  std::size_t conditions_;
  Table table_;
  bool measured_ = false;
};

const char* kMeasures =
    "alpha: mean angle to the true normals [deg]; r_p: 100 x planes found / true; r_m: % of points "
    "in no plane.";

/// Tables I and III: ours with and without pointwise classification.
std::optional<Table> with_and_without(const Conditions& conditions,
                                      const std::string& title,
                                      const std::vector<std::string>& columns) {
  PaperTable table(title, {"", "profile", "labels"}, columns);
  table.add_printed({"with PC", "printed", ""}, conditions.printed("ours", true));
  for (const std::string& profile : profiles_of_ours())
    for (const char* labels : {"truth", "gcn", "pca"})
      table.add_measured({"with PC", profile, labels},
                         conditions.measured(with_ours({}, profile, labels)));
  table.add_printed({"w/o PC", "printed", ""}, conditions.printed("ours", false));
  for (const std::string& profile : profiles_of_ours())
    table.add_measured({"w/o PC", profile, "none"},
                       conditions.measured(with_ours({}, profile, "none")));
  return std::move(table).table(fmt::format("{} {}.", kMeasures, conditions.frames_text()));
}

std::optional<Table> table_1(const PaperResults& results) {
  std::vector<CellKey> frames;
  for (const int points : {2048, 4096, 8192}) frames.push_back(stairs_of(results.seed, points, 0));
  return with_and_without({results, "I", frames}, "Table I: number of points",
                          {"2048", "4096", "8192"});
}

std::optional<Table> table_3(const PaperResults& results) {
  std::vector<CellKey> frames;
  for (const double noise : {0.0, 0.1, 0.2, 0.3})
    frames.push_back(stairs_of(results.seed, 8192, noise));
  return with_and_without({results, "III", frames}, "Table III: noise, 8192 points",
                          {"0.0 cm", "0.1 cm", "0.2 cm", "0.3 cm"});
}

std::optional<Table> table_5(const PaperResults& results) {
  std::vector<CellKey> frames;
  for (const double noise : {0.05, 0.1, 0.15, 0.2})
    frames.push_back(stairs_of(results.seed, 8192, noise));
  const Conditions conditions(results, "V", frames);
  PaperTable table("Table V: comparison, 8192 points", {"method", "profile", "labels"},
                   {"0.05 cm", "0.10 cm", "0.15 cm", "0.20 cm"});
  const auto rival = [&](const char* name, const char* method, const char* setting) {
    table.add_measured({name, "measured", ""},
                       conditions.measured(with_rival({}, method, setting)));
  };
  table.add_printed({"RANSAC 0.01", "printed", ""}, conditions.printed("ransac", true));
  rival("RANSAC 0.01", "ransac", "");
  rival("RANSAC 0.02", "ransac", kRansacCoarse);
  table.add_printed({"region growing", "printed", ""}, conditions.printed("region-growing", true));
  rival("region growing", "region-growing", "");
  table.add_printed({"ours", "printed", ""}, conditions.printed("ours", true));
  for (const std::string& profile : profiles_of_ours())
    for (const char* labels : {"truth", "gcn", "pca"})
      table.add_measured({"ours", profile, labels},
                         conditions.measured(with_ours({}, profile, labels)));
  return std::move(table).table(
      fmt::format("{} {}. The paper names two thresholds for RANSAC and prints the one of 0.01 m.",
                  kMeasures, conditions.frames_text()));
}

std::optional<Table> table_4(const PaperResults& results) {
  if (results.real.empty()) return std::nullopt;
  Table table{
      "Table IV: sizes of real data",
      "N_m: points within 1.5 m; N_d: voxels of 2 cm; planes: found by profile refined with "
      "labels by gcn. Means over the frames. Refused: frames whose gravity nothing tells. "
      "Times are in a table of their own.",
      {"recording", "frames", "refused", "N_m", "N_d", "planes"},
      {},
      1};
  for (const PrintedReal& row : printed_real())
    table.rows.push_back(
        {"printed, " + row.scene, "-", "-", std::to_string(row.n_m), std::to_string(row.n_d), "-"});
  for (const RealRow& row : results.real)
    table.rows.push_back({row.recording, std::to_string(row.frames), std::to_string(row.refused),
                          fixed(row.n_m, 0), fixed(row.n_d, 0), fixed(row.planes, 1)});
  return table;
}

}  // namespace

std::vector<Table> paper_tables(const PaperResults& results) {
  std::vector<Table> tables;
  for (const auto make : {table_1, table_3, table_4, table_5})
    if (std::optional<Table> table = make(results)) tables.push_back(std::move(*table));
  return tables;
}

// ---- How long it took ----

// Tables II and IV, and the frames a second beside table V.

namespace {

Table classifier_table(const PaperTimings& timings) {
  Table table{"Table II: classifier time [ms]",
              fmt::format("Medians of rounds in which all take turns, on the stairs. {}. The "
                          "paper's was measured on a GPU.",
                          to_text(timings.machine)),
              {"labels by", "threads"},
              {},
              2};
  std::vector<std::string> printed = {"printed (3D-GCN, RTX 3090)", "-"};
  for (const PrintedClassifierTime& time : printed_classifier_times()) {
    table.columns.push_back(fmt::format("{} points", time.points));
    printed.push_back(fixed(time.ms, 0));
  }
  table.rows.push_back(printed);
  for (const ClassifierTiming& first : timings.classifiers) {
    if (first.points != printed_classifier_times()[0].points) continue;
    std::vector<std::string> row = {first.classifier, std::to_string(first.threads)};
    for (const PrintedClassifierTime& time : printed_classifier_times())
      for (const ClassifierTiming& other : timings.classifiers)
        if (other.classifier == first.classifier && other.threads == first.threads &&
            other.points == time.points)
          row.push_back(fixed(other.median_ms, 2));
    row.resize(table.columns.size(), "-");
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table real_table(const PaperTimings& timings) {
  Table table{"Table IV: times of real data [ms]",
              fmt::format("t_d voxel grid, t_c labels (gcn), t_b octree, t_s planes (refined), FPS "
                          "of these four; medians over the frames, {} threads. {}.",
                          timings.threads, to_text(timings.machine)),
              {"recording", "frames", "t_d", "t_c", "t_b", "t_s", "FPS"},
              {},
              1};
  for (const PrintedReal& row : printed_real())
    table.rows.push_back({"printed, " + row.scene, "-", fixed(row.t_d_ms, 1), fixed(row.t_c_ms, 1),
                          fixed(row.t_b_ms, 1), fixed(row.t_s_ms, 1), speed_text(row.fps)});
  for (const RealTiming& row : timings.real)
    table.rows.push_back({row.recording, std::to_string(row.frames), fixed(row.t_d_ms, 2),
                          fixed(row.t_c_ms, 2), fixed(row.t_b_ms, 2), fixed(row.t_s_ms, 2),
                          speed_text(row.fps)});
  return table;
}

Table method_table(const PaperTimings& timings) {
  Table table{
      "Table V: frames a second",
      fmt::format("Whole frames of the stairs, 8192 points with {} cm of noise, from points "
                  "to planes on one thread; medians of rounds in which all take turns. {}.",
                  timings.methods[0].key.noise_cm, to_text(timings.machine)),
      {"method", "FPS"},
      {},
      1};
  for (const PrintedFps& printed : printed_fps())
    table.rows.push_back({"printed, " + printed.method, fixed(printed.fps, 1)});
  for (const MethodTiming& method : timings.methods)
    table.rows.push_back({contestant_name(method.key), speed_text(method.fps)});
  return table;
}

}  // namespace

std::vector<Table> timing_tables(const PaperTimings& timings) {
  std::vector<Table> tables;
  if (!timings.classifiers.empty()) tables.push_back(classifier_table(timings));
  if (!timings.real.empty()) tables.push_back(real_table(timings));
  if (!timings.methods.empty()) tables.push_back(method_table(timings));
  return tables;
}

}  // namespace planescope::lab
