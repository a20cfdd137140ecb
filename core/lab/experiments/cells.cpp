// Cells of the paper's experiments: names, options, and the plan of all cells.

#include "core/lab/experiments/cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/lab/rivals/rivals.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::lab {
namespace {

constexpr const char* kWithout = "without ";
constexpr const char* kStairs = "stairs";
constexpr int kPoints = 8192;

const std::vector<std::string> kProfiles = {"paper", "paper-closest", "refined"};
const std::vector<std::string> kLabels = {"truth", "gcn", "pca"};

const std::vector<std::string> kHardCloudSets = {"side_walls", "open_risers", "equal_boxes",
                                                 "ramps",      "kerbs",       "spiral"};

bool is_depth(const CellKey& frames) { return frames.points == 0; }

class Plan {
 public:
  void add(const CellKey& key) {
    if (std::ranges::find(keys_, key) == keys_.end()) keys_.push_back(key);
  }
  /// Our methods in the paper's tables: every profile with every source of labels, and without.
  void add_profiles(const CellKey& frames) {
    for (const std::string& profile : kProfiles) {
      for (const std::string& labels : kLabels) add(with_ours(frames, profile, labels));
      add(with_ours(frames, profile, "none"));
    }
  }
  /// Contestants of the stricter tables.
  void add_methods(const CellKey& frames) {
    for (const std::string& labels : kLabels)
      if (labels == "gcn" || !is_depth(frames))  // on depth images, labels are not used
        add(with_ours(frames, "refined", labels));
    for (const std::string& method : rival_names(is_depth(frames))) {
      add(with_rival(frames, method));
      if (method == "ransac") add(with_rival(frames, method, kRansacCoarse));
    }
    // The oracle needs the plane boundaries, which are unknown for real frames.
    if (frames.seed != 0) add(with_rival(frames, "oracle"));
  }
  void add_ablation(const CellKey& frames) {
    for (const CellKey& key : ablations(frames, is_depth(frames))) add(key);
  }
  /// Methods compared by a claim, on the tuning frames.
  void add_tuned(const CellKey& frames) {
    add(with_ours(frames, "refined", "gcn"));
    add(with_rival(frames, "oracle"));
  }
  std::vector<CellKey> keys() && { return std::move(keys_); }

 private:
  std::vector<CellKey> keys_;
};

}  // namespace

const std::vector<std::string>& depth_sets() {
  static const std::vector<std::string> sets = {"depth_stairs", "depth_boxes", "depth_slopes"};
  return sets;
}

CellKey clouds_of(const std::string& set, std::uint64_t seed, int points, double noise_cm) {
  return {.set = set, .seed = seed, .points = points, .noise_cm = noise_cm};
}

CellKey depth_of(const std::string& set, std::uint64_t seed, const std::string& errors) {
  return {.set = set, .seed = seed, .errors = errors};
}

CellKey with_ours(CellKey frames,
                  const std::string& profile,
                  const std::string& classifier,
                  const std::string& setting) {
  frames.method = "ours";
  frames.profile = profile;
  frames.classifier = classifier;
  frames.setting = setting;
  return frames;
}

CellKey with_rival(CellKey frames, const std::string& method, const std::string& setting) {
  frames.method = method;
  frames.setting = setting;
  return frames;
}

bool same_frames(const CellKey& a, const CellKey& b) {
  return a.set == b.set && a.seed == b.seed && a.points == b.points && a.noise_cm == b.noise_cm &&
         a.errors == b.errors;
}

std::vector<CellKey> ablations(const CellKey& frames, bool of_depth) {
  // Named by the options that are set to 0.
  static const std::vector<std::string> depth = {"bow", "lateral_px", "hidden_share", "worth_px"};
  static const std::vector<std::string> clouds = {"bow", "label_sigma", "plane_cost"};
  std::vector<CellKey> keys;
  for (const std::string& term : of_depth ? depth : clouds)
    keys.push_back(with_ours(frames, "refined", "gcn", kWithout + term));
  return keys;
}

std::string frames_name(const CellKey& key) {
  std::string name = key.set;
  if (key.points > 0) name += fmt::format(", {} points, {} cm", key.points, key.noise_cm);
  if (!key.errors.empty()) name += ", " + key.errors;
  return name;
}

std::string contestant_name(const CellKey& key) {
  std::string name = key.method;
  for (const std::string* part : {&key.profile, &key.classifier, &key.setting})
    if (!part->empty()) name += " " + *part;
  return name;
}

planes::PipelineOptions cell_options(const CellKey& key) {
  planes::PipelineOptions options;
  options.threads = 1;
  if (key.set == kRealLabeled) options.cloud.max_range_m = 4;  // all of it is farther than 1.5 m
  if (key.points > 0) options.cloud.voxel_size_m = 0;  // points are scored, each its own voxel
  if (key.method != "ours") {
    options.method = find_library_rival(key.method) ? planes::Method::region_growing
                                                    : planes::parse_method(key.method);
    if (key.setting == kRansacCoarse) options.rivals.ransac.theta_pf_m = 0.02;
    return options;
  }
  options.segment = planes::profile_options(planes::parse_profile(key.profile));
  options.segment.use_labels = key.classifier != "none";
  if (key.setting.starts_with(kWithout))
    planes::set_option(options, key.setting.substr(std::string(kWithout).size()), "0");
  return options;
}

std::vector<CellKey> planned_cells(const PaperPlan& plan) {
  const auto stairs = [](std::uint64_t seed, int points, double noise_cm) {
    return clouds_of(kStairs, seed, points, noise_cm);
  };
  Plan cells;
  for (const int points : {2048, 4096}) {
    cells.add_profiles(stairs(plan.seed, points, 0));
    cells.add_methods(stairs(plan.seed, points, 0));
  }
  for (const double noise_cm : {0.0, 0.05, 0.1, 0.15, 0.2, 0.3}) {
    cells.add_profiles(stairs(plan.seed, kPoints, noise_cm));
    cells.add_methods(stairs(plan.seed, kPoints, noise_cm));
  }
  cells.add_ablation(stairs(plan.seed, kPoints, 0.3));
  const std::vector<double> hard_noise_cm =
      plan.quick ? std::vector<double>{0.2} : std::vector<double>{0, 0.2};
  for (const std::string& set : kHardCloudSets)
    for (const double noise_cm : hard_noise_cm)
      cells.add_methods(clouds_of(set, plan.seed, kPoints, noise_cm));
  const std::vector<std::string> errors = plan.quick
                                              ? std::vector<std::string>{"clean", "d435"}
                                              : std::vector<std::string>{"clean", "noise", "d435"};
  for (const std::string& set : depth_sets())
    for (const std::string& error : errors) {
      const CellKey frames = depth_of(set, plan.seed, error);
      if (error == "d435")
        for (const std::string& profile : kProfiles) cells.add(with_ours(frames, profile, "gcn"));
      cells.add_methods(frames);
      if (error == "d435") cells.add_ablation(frames);
    }
  if (plan.real_labeled) {
    const CellKey frame{.set = kRealLabeled};
    for (const std::string& profile : kProfiles) cells.add(with_ours(frame, profile, "gcn"));
    cells.add_methods(frame);
  }
  cells.add_tuned(stairs(plan.tuning_seed, 2048, 0));
  for (const double noise_cm : {0.0, 0.1, 0.2, 0.3})
    cells.add_tuned(stairs(plan.tuning_seed, kPoints, noise_cm));
  for (const std::string& set : depth_sets())
    cells.add_tuned(depth_of(set, plan.tuning_seed, "d435"));
  std::vector<CellKey> keys = std::move(cells).keys();
  if (!plan.sets.empty())
    std::erase_if(keys, [&](const CellKey& key) {
      return std::ranges::find(plan.sets, key.set) == plan.sets.end();
    });
  return keys;
}

int planned_frames(const PaperPlan& plan, const std::string& set) {
  int frames = set == kRealLabeled ? 1 : find_evaluation_set(set).frames;
  if (plan.quick) frames = std::min(frames, set == kStairs ? 8 : 2);
  return plan.count > 0 ? std::min(frames, plan.count) : frames;
}

}  // namespace planescope::lab
