#pragma once

// Cells, each of which is a set of frames and a method, and the plan of cells for the paper.

#include <cstdint>
#include <string>
#include <vector>

#include "core/model/json_fields.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// A set of frames, and the method that segments them.
struct CellKey {
  std::string set = {};         // of evaluation_sets(), or "icl_nuim"
  std::uint64_t seed = 0;       // 0: not from a seed
  int points = 0;               // of clouds
  double noise_cm = 0;          // of clouds
  std::string errors = {};      // of depth images: "clean", "noise", "d435"
  std::string method = {};      // "ours", "ransac", ... as in --method, or "oracle"
  std::string profile = {};     // of ours: "paper", "paper-closest", "refined"
  std::string classifier = {};  // of ours: "truth", "gcn", "pca", "none" (all points one label)
  std::string setting = {};     // deviation from the defaults: "theta_pf 0.02", "without bow"

  bool operator==(const CellKey&) const = default;
};
void visit_fields(auto& fields, Same<CellKey> auto& key) {
  fields("set", key.set);
  fields.with_default("seed", key.seed, 0);
  fields.with_default("points", key.points, 0);
  fields.with_default("noise_cm", key.noise_cm, 0);
  fields.with_default("errors", key.errors, "");
  fields("method", key.method);
  fields.with_default("profile", key.profile, "");
  fields.with_default("classifier", key.classifier, "");
  fields.with_default("setting", key.setting, "");
}

/// The mean over a set's frames. Clouds are scored by point, depth images by voxel.
struct Cell {
  CellKey key;
  int frames = 0;
  planes::Metrics metrics;
};

/// The other threshold in the paper for RANSAC, 0.02 m.
inline constexpr const char* kRansacCoarse = "theta_pf 0.02";

// Names of sets and conditions in cells.
inline constexpr const char* kRealLabeled = "icl_nuim";  // the labeled frame of $PLANESCOPE_DATA
const std::vector<std::string>& depth_sets();

/// Keys without a method: only the frames.
CellKey clouds_of(const std::string& set, std::uint64_t seed, int points, double noise_cm);
CellKey depth_of(const std::string& set, std::uint64_t seed, const std::string& errors);

/// The same frames with another method.
CellKey with_ours(CellKey frames,
                  const std::string& profile,
                  const std::string& classifier,
                  const std::string& setting = "");
CellKey with_rival(CellKey frames, const std::string& method, const std::string& setting = "");

/// Whether both have the same frames.
bool same_frames(const CellKey& a, const CellKey& b);

/// Ours in profile refined with labels by gcn, each without one term of its objective. `of_depth`:
/// for depth images, otherwise for clouds.
std::vector<CellKey> ablations(const CellKey& frames, bool of_depth);

/// "stairs, 8192 points, 0.1 cm", "depth_boxes, d435"
std::string frames_name(const CellKey& key);
/// "ours refined gcn", "ransac theta_pf 0.02"
std::string contestant_name(const CellKey& key);

/// The options for a cell's frames: method, profile, setting; one thread. For methods outside the
/// product (find_library_rival()), everything except the method.
planes::PipelineOptions cell_options(const CellKey& key);

struct PaperPlan {
  std::uint64_t seed = 1, tuning_seed = 1001;
  std::vector<std::string> sets = {};  // empty: all
  int count = 0;                       // maximum frames of a set; 0: no limit
  bool quick = false;                  // fewer conditions of the sets that are not in the paper
  bool real_labeled = false;           // with the labeled frame
};
/// In the order of the tables, unique; cells of the same frames are adjacent.
std::vector<CellKey> planned_cells(const PaperPlan& plan);
/// Number of frames of a set in a cell's mean.
int planned_frames(const PaperPlan& plan, const std::string& set);

}  // namespace planescope::lab
