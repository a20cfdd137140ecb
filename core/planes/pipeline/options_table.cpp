#include "core/planes/pipeline/options_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/classifiers.hpp"
#include "core/planes/pipeline/option_row.hpp"

namespace planescope::planes {
namespace {

// The member that a row reads and writes, by its path from PipelineOptions.
template <typename Stage, typename T>
auto member(Stage PipelineOptions::*stage, T Stage::*field) {
  return [=](auto& options) -> auto& { return options.*stage.*field; };
}
template <typename T>
auto in_cloud(T CloudOptions::*field) {
  return member(&PipelineOptions::cloud, field);
}
template <typename T>
auto in_segment(T SegmentOptions::*field) {
  return member(&PipelineOptions::segment, field);
}

std::string gravity_text(const GravityOptions& gravity) {
  switch (gravity.mode) {
    case GravityMode::automatic:
      return "auto";
    case GravityMode::imu:
      return "imu";
    case GravityMode::estimate:
      return "estimate";
    case GravityMode::none:
      return "none";
    case GravityMode::fixed:
      break;
  }
  const Vec3d& d = gravity.direction;
  return fmt::format("{},{},{}", d.x(), d.y(), d.z());
}

/// The paper's symbols, for whoever shows an option beside its equation.
void name_symbols(std::vector<OptionInfo>& table) {
  const std::pair<const char*, const char*> symbols[] = {{"theta_n_out", "θ_Nout"},
                                                         {"theta_r_out", "θ_rout"},
                                                         {"theta_n_in", "θ_Nin"},
                                                         {"theta_e_n_m2", "θ_en"},
                                                         {"theta_coplane", "θ_coplane"}};
  for (const auto& [name, symbol] : symbols)
    for (OptionInfo& info : table)
      if (info.name == name) info.symbol = symbol;
}

/// What people call an option, for whoever shows it.
void name_titles(std::vector<OptionInfo>& table) {
  static const std::map<std::string, const char*> titles = {
      {"max_range_m", "Maximum range"},
      {"range_for_clouds", "Limit clouds to the range"},
      {"cube_edge_m", "Octree cube"},
      {"voxel_size_m", "Voxel size"},
      {"base_depth", "Octree depth"},
      {"gravity", "Gravity"},
      {"gravity_max_tilt_deg", "Largest camera tilt"},
      {"classifier", "Classifier"},
      {"pca_neighbours", "PCA neighbors"},
      {"pca_max_angle_deg", "PCA angle limit"},
      {"method", "Method"},
      {"profile", "Profile"},
      {"theta_n_out", "Most outliers"},
      {"theta_r_out", "Largest outlier share"},
      {"theta_n_in", "Fewest inliers"},
      {"theta_e_n_m2", "Largest fit error"},
      {"mse_normalization", "Fit error is over"},
      {"theta_coplane", "Least coplanarity"},
      {"criterion4_n2", "Ask for the third line"},
      {"merge_offset_m", "Largest merge offset"},
      {"merge_partner", "Merge partner"},
      {"leftover_distance_m", "Assignment distance"},
      {"use_labels", "Use labels"},
      {"cube_anchor", "Cube anchor"},
      {"flat", "Cell flatness"},
      {"bow", "Bow allowed"},
      {"merge_cost", "Merge cost"},
      {"two_planes", "Two-plane split"},
      {"filled", "Least filled share"},
      {"lateral_px", "Lateral error"},
      {"reach_sigma", "Cost of unexplained pixels"},
      {"hidden_share", "Joining hidden parts"},
      {"worth_px", "Least worth of a plane"},
      {"undecided", "Margin of undecided planes"},
      {"resolution", "Spacing noise"},
      {"point_reach_sigma", "Cost of unexplained points"},
      {"label_sigma", "Label penalty"},
      {"plane_cost", "Plane cost"},
      {"ransac_theta_pf_m", "Inlier distance"},
      {"ransac_iterations", "Iterations"},
      {"ransac_min_points", "Fewest points"},
      {"ransac_seed", "Random seed"},
      {"region_patch_px", "Cell of images"},
      {"region_voxel_size_m", "Cell of clouds"},
      {"region_threshold_m2", "Planarity threshold"},
      {"region_merge_threshold", "Merge threshold"},
      {"region_refine_boundaries", "Refine boundaries"},
      {"foot_radius_m", "Foot radius"},
      {"foot_margin_m", "Margin around the foot"},
      {"foot_unknown_share", "Unmeasured holes allowed"},
      {"foot_max_off_m", "Largest deviation"},
      {"foot_max_slope_deg", "Steepest slope"},
      {"foot_min_area_m2", "Least area"},
      {"foot_max_rough_m", "Largest roughness"},
      {"foot_min_support", "Least support"},
      {"stairs_rise_min_m", "Lowest rise"},
      {"stairs_rise_max_m", "Highest rise"},
      {"stairs_going_min_m", "Shortest going"},
      {"stairs_going_max_m", "Longest going"},
      {"stairs_width_min_m", "Least width"},
      {"stairs_rise_spread_m", "Spread of rises"},
      {"stairs_going_spread_m", "Spread of goings"},
      {"stairs_turn_deg", "Angle between nosings"},
      {"stairs_gap_m", "Largest gap"},
      {"stairs_level_deg", "Ramps from this tilt"},
      {"stairs_landing_goings", "Landings from this depth"},
      {"stairs_kerb_width_m", "Least kerb width"},
      {"stairs_kerb_depth_m", "Least depth beside a kerb"},
      {"stairs_floor_m2", "Least floor area"}};
  for (OptionInfo& info : table) info.title = titles.at(info.name);
}

void append_cloud(std::vector<OptionInfo>& table) {
  const std::string s = "cloud";
  table.push_back(number(s, "max_range_m", "m",
                         "Depth z beyond which pixels are ignored (depth images)",
                         in_cloud(&CloudOptions::max_range_m), {0, 1000, true}));
  table.push_back(flag(s, "range_for_clouds",
                       "Ignore points farther than max_range_m from the origin (clouds)",
                       in_cloud(&CloudOptions::range_for_clouds)));
  table.push_back(number(s, "cube_edge_m", "m",
                         "Smallest edge of the octree's cube; doubled until it contains the range",
                         in_cloud(&CloudOptions::cube_edge_m), {0.01, 10000}));
  table.push_back(number(s, "voxel_size_m", "m", "Voxel edge; 0 makes every point a voxel",
                         in_cloud(&CloudOptions::voxel_size_m), {0, 10}));
  table.push_back(
      number(s, "base_depth", "levels",
             "Octree depth of a cube of cube_edge_m: 8 gives leaves of 1.25 cm in 3.2 m",
             in_cloud(&CloudOptions::base_depth), {1, 16}));
}

void append_gravity(std::vector<OptionInfo>& table) {
  const std::string s = "gravity";
  table.push_back({"gravity", "auto/X,Y,Z/imu/estimate/none",
                   "Gravity direction in the frame of the sensor or cloud; none: without "
                   "horizontal and vertical",
                   s, [](const PipelineOptions& o) { return gravity_text(o.gravity); },
                   [](PipelineOptions& o, const std::string& text) {
                     const GravityOptions parsed = parse_gravity(text);
                     o.gravity.mode = parsed.mode;
                     o.gravity.direction = parsed.direction;
                   }});
  table.push_back(number(
      s, "gravity_max_tilt_deg", "deg", "Largest camera tilt that the gravity estimate allows",
      member(&PipelineOptions::gravity, &GravityOptions::max_tilt_deg), {0, 90, true}));
}

void append_classifier(std::vector<OptionInfo>& table) {
  const std::string s = "classifier";
  table.push_back({"classifier", "gcn/pca/truth/FILE",
                   "Labels points horizontal or vertical: a network, PCA normals, or ground truth",
                   s, [](const PipelineOptions& o) { return o.classifier; },
                   [](PipelineOptions& o, const std::string& text) {
                     if (text != "gcn" && text != "pca" && text != "truth" &&
                         !names_weights_file(text))
                       throw Error("classifier '" + text +
                                   "' does not exist, expected gcn, pca, truth or a weights file");
                     o.classifier = text;
                   }});
  table.push_back(number(
      s, "pca_neighbours", "points", "Points in each local plane fit, including the point itself",
      member(&PipelineOptions::pca, &PcaClassifierOptions::neighbours), {3, 1000}));
  table.push_back(number(s, "pca_max_angle_deg", "deg",
                         "Eq. (1): horizontal if the normal is within this angle of gravity",
                         member(&PipelineOptions::pca, &PcaClassifierOptions::max_angle_deg),
                         {0, 90}));
}

void append_method(std::vector<OptionInfo>& table) {
  std::vector<std::string> names;
  for (const Method method : built_methods()) names.push_back(to_string(method));
  table.push_back(
      {"method",
       fmt::format("{}", fmt::join(names, "/")),
       "Method that finds planes: ours, or a rival",
       "method",
       [](const PipelineOptions& o) { return to_string(o.method); },
       [](PipelineOptions& o, const std::string& text) { o.method = parse_method(text); },
       OptionKind::choice,
       {},
       names});
}

void append_criteria(std::vector<OptionInfo>& table) {
  const std::string s = "criteria";
  table.push_back({"profile",
                   "paper/paper-closest/refined",
                   "Sets all options below to the defaults of a profile",
                   s,
                   [](const PipelineOptions& o) { return to_string(o.segment.profile); },
                   [](PipelineOptions& o, const std::string& text) {
                     o.segment = profile_options(find_profile(text));
                   },
                   OptionKind::choice,
                   {},
                   {"paper", "paper-closest", "refined"}});
  table.push_back(number(s, "theta_n_out", "points", "Criterion 1: most outliers of a node",
                         in_segment(&SegmentOptions::theta_n_out)));
  table.push_back(number(s, "theta_r_out", "share",
                         "Criterion 1: largest share of outliers in a node",
                         in_segment(&SegmentOptions::theta_r_out), {0, 1}));
  table.push_back(number(s, "theta_n_in", "points", "Criterion 2: fewest inliers of a node",
                         in_segment(&SegmentOptions::theta_n_in), {3, 1e9}));
  table.push_back(number(s, "theta_e_n_m2", "m2",
                         "Criterion 3: largest error e_n of the inliers' plane fit",
                         in_segment(&SegmentOptions::theta_e_n_m2)));
  table.push_back(
      choice(s, "mse_normalization", {"scatter", "mean"},
             "e_n is the smallest eigenvalue of the scatter as printed, or divided by N",
             in_segment(&SegmentOptions::mse_normalization)));
  table.push_back(number(s, "theta_coplane", "1",
                         "Criterion 4: smallest coplanarity of two merged candidates",
                         in_segment(&SegmentOptions::theta_coplane), {0, 1}));
  table.push_back(flag(s, "criterion4_n2",
                       "Criterion 4: also evaluate its third line, with the candidate's normal",
                       in_segment(&SegmentOptions::criterion4_n2)));
  table.push_back(number(s, "merge_offset_m", "m",
                         "Criterion 4: largest |n . dmu|; 0 disables the test",
                         in_segment(&SegmentOptions::merge_offset_m)));
  table.push_back(choice(s, "merge_partner", {"first", "best"},
                         "Coplanar plane that a candidate is merged into",
                         in_segment(&SegmentOptions::merge_partner)));
  table.push_back(number(s, "leftover_distance_m", "m",
                         "Largest distance at which an unassigned point is assigned to a plane",
                         in_segment(&SegmentOptions::leftover_distance_m)));
  table.push_back(flag(s, "use_labels", "Off: all points have one label, the paper's \"w/o PC\"",
                       in_segment(&SegmentOptions::use_labels)));
  table.push_back(choice(s, "cube_anchor", {"center", "min_corner"},
                         "Cube centered by the cloud stage, or starting at the minimum corner of "
                         "the points",
                         in_segment(&SegmentOptions::cube_anchor)));
  for (const char* name : {"theta_e_n_m2", "mse_normalization", "theta_coplane", "criterion4_n2",
                           "merge_offset_m", "merge_partner", "leftover_distance_m"})
    std::ranges::find(table, name, &OptionInfo::name)->objective = false;
}

/// Takes the rows that a stage's options describe; `stage` finds these in PipelineOptions.
template <typename Stage>
class Rows {
 public:
  Rows(std::vector<OptionInfo>& table, Stage stage, std::string section)
      : table_(table), stage_(stage), section_(std::move(section)) {}

  template <typename Options, typename T>
  void number(const char* name,
              const char* unit,
              const char* meaning,
              T Options::*field,
              OptionRange range = {}) {
    add(planescope::planes::number(section_, name, unit, meaning, of(field), range));
  }
  template <typename Options>
  void flag(const char* name, const char* meaning, bool Options::*field) {
    add(planescope::planes::flag(section_, name, meaning, of(field)));
  }
  template <typename Options, typename T>
  void choice(const char* name,
              std::vector<std::string> values,
              const char* meaning,
              T Options::*field) {
    add(planescope::planes::choice(section_, name, std::move(values), meaning, of(field)));
  }

  /// The rows that follow are read only for depth images, or only for clouds.
  void read_by_images(bool images) { images_ = images; }

 private:
  template <typename Options, typename T>
  auto of(T Options::*field) {
    return [ stage = stage_, field ](auto& o) -> auto& { return stage(o).*field; };
  }
  void add(OptionInfo row) {
    if (section_ == "objective") row.objective = true;
    row.images = images_;
    table_.push_back(std::move(row));
  }

  std::vector<OptionInfo>& table_;
  Stage stage_;
  std::string section_;
  std::optional<bool> images_;
};

void append_objective(std::vector<OptionInfo>& table) {
  Rows rows(
      table, [](auto& o) -> auto& { return o.segment.objective; }, "objective");
  ObjectiveOptions::describe(rows);
}

void append_foot(std::vector<OptionInfo>& table) {
  Rows rows(
      table, [](auto& o) -> auto& { return o.foot; }, "foot");
  FootOptions::describe(rows);
}

void append_stairs(std::vector<OptionInfo>& table) {
  Rows rows(
      table, [](auto& o) -> auto& { return o.stairs; }, "stairs");
  StairsOptions::describe(rows);
}

}  // namespace

void check_option_range(double value, const OptionRange& range, const std::string& name) {
  const bool low = range.min_excluded ? value <= range.min : value < range.min;
  if (!low && value <= range.max) return;
  const std::string at_least = fmt::format("{} {}", range.min_excluded ? ">" : ">=", range.min);
  throw Error(fmt::format(
      "option {}: {} is out of range, expected {}", name, value,
      std::isinf(range.max) ? at_least : fmt::format("{} and <= {}", at_least, range.max)));
}

bool is_idle(const OptionInfo& info, const PipelineOptions& options, std::optional<bool> images) {
  const bool refined = options.segment.by_objective();
  return (info.objective && *info.objective != refined) ||
         (finds_on_pixels(options) && images && info.images && *info.images != *images);
}

const std::vector<OptionInfo>& option_table() {
  static const std::vector<OptionInfo> table = [] {
    std::vector<OptionInfo> rows;
    append_cloud(rows);
    append_gravity(rows);
    append_classifier(rows);
    append_method(rows);
    append_criteria(rows);
    append_objective(rows);
    for (OptionInfo& row : rows)
      if (row.section == "classifier" || row.steers_segmentation()) row.method = Method::ours;
    append_rivals(rows);
    append_foot(rows);
    append_stairs(rows);
    for (const char* name : {"cube_edge_m", "voxel_size_m", "base_depth", "classifier",
                             "pca_neighbours", "pca_max_angle_deg", "theta_n_out", "theta_r_out",
                             "theta_n_in", "use_labels", "cube_anchor"})
      std::ranges::find(rows, name, &OptionInfo::name)->images = false;
    name_symbols(rows);
    name_titles(rows);
    return rows;
  }();
  return table;
}

const OptionInfo& find_option(const std::string& name, std::span<const RemovedOption> removed) {
  std::vector<std::string> names;
  for (const OptionInfo& info : option_table()) {
    if (info.name == name) return info;
    names.push_back(info.name);
  }
  if (const std::string text = removed_text("option", name, removed); !text.empty())
    throw Error(text);
  const std::string near = nearest_name(name, names);
  throw Error("option '" + name + "' is unknown" +
              (near.empty() ? std::string(", `planescope options` lists what there is")
                            : ", did you mean '" + near + "'?"));
}

Profile find_profile(const std::string& name, std::span<const RemovedOption> removed) {
  if (const std::string text = removed_text("profile", name, removed); !text.empty())
    throw Error(text);
  return parse_profile(name);
}

std::string default_value(const OptionInfo& info, Profile profile) {
  PipelineOptions options;
  options.segment = profile_options(profile);
  return info.get(options);
}

double number_of(const OptionInfo& info, const PipelineOptions& options) {
  assert(info.is_number());
  return parse_number(info.get(options), "option " + info.name);
}

std::string number_text(const OptionInfo& info, double value) {
  assert(info.is_number());
  const OptionRange& range = info.range;
  value = std::clamp(value, range.min, range.max);
  if (info.kind == OptionKind::whole)  // whole numbers are int
    return fmt::format("{}", std::lround(std::min(value, 2147483647.0)));
  if (range.min_excluded && value <= range.min)
    value = std::nextafter(range.min, std::numeric_limits<double>::infinity());
  return fmt::format("{}", value);
}

void set_option(PipelineOptions& options, const std::string& name, const std::string& value) {
  find_option(name).set(options, value);
}

}  // namespace planescope::planes
