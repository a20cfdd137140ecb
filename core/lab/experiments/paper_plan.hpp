#pragma once

// Which cells the experiments consist of; the paper's tables and the stricter ones are made from
// them.

#include <optional>
#include <string>
#include <vector>

#include "core/lab/experiments/results.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// The other threshold that the paper tries with RANSAC, 0.02 m.
inline constexpr const char* kRansacCoarse = "theta_pf 0.02";

// What the sets' names and conditions are in cells.
inline constexpr const char* kStairs = "stairs";
inline constexpr const char* kRealLabelled = "icl_nuim";  // the labelled frame of $PLANESCOPE_DATA
const std::vector<std::string>& depth_sets();

/// Keys without a method: which frames are segmented.
CellKey stairs_of(std::uint64_t seed, int points, double noise_cm);
CellKey clouds_of(const std::string& set, std::uint64_t seed, double noise_cm);  // 8192 points
CellKey depth_of(const std::string& set, std::uint64_t seed, const std::string& errors);

/// The same frames with a method, or with another one.
CellKey with_ours(CellKey frames,
                  const std::string& profile,
                  const std::string& classifier,
                  const std::string& setting = "");
CellKey with_rival(CellKey frames, const std::string& method, const std::string& setting = "");

CellKey with_method_of(CellKey frames, const CellKey& other);

/// Whether both are of the same frames.
bool same_frames(const CellKey& a, const CellKey& b);

/// The terms of the objective that an ablation leaves out, by the options that are 0 then.
/// `of_depth`: on depth images, otherwise on clouds.
const std::vector<std::string>& objective_terms(bool of_depth);
const std::vector<std::string>& profiles_of_ours();
std::string without(const std::string& term);  // as a setting

/// "stairs, 8192 points, 0.1 cm", "depth_boxes, d435"
std::string frames_name(const CellKey& key);
/// "ours refined gcn", "ransac theta_pf 0.02"
std::string contestant_name(const CellKey& key);

/// The options that a cell's frames are run with: method, profile, setting; one thread.
planes::PipelineOptions cell_options(const CellKey& key);

struct PaperPlan {
  std::uint64_t seed = 1, tuning_seed = 1001;
  std::vector<std::string> sets;  // empty: all
  int count = 0;                  // frames of a set at most; 0: all that it has
  bool quick = false;             // fewer conditions of the sets that the paper lacks
  bool real_labelled = false;     // with the labelled frame
};
/// In the order of the tables, none twice; cells of the same frames lie side by side.
std::vector<CellKey> planned_cells(const PaperPlan& plan);
/// How many frames of its set a cell is the mean of.
int planned_frames(const PaperPlan& plan, const std::string& set);

}  // namespace planescope::lab
