// The table of all options, and profile files.

#include "core/planes/pipeline/options_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

namespace planescope::planes {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// ---- Rows ----

/// Throws Error if the value is out of range.
void check_range(double value, const OptionRange& range, const std::string& name) {
  const bool low = range.min_excluded ? value <= range.min : value < range.min;
  if (!low && value <= range.max) return;
  const std::string at_least =
      fmt::format("{} {}", range.min_excluded ? "more than" : "at least", range.min);
  throw Error(fmt::format(
      "option {}: {} is out of range; expected {}", name, value,
      std::isinf(range.max) ? at_least : fmt::format("{} and at most {}", at_least, range.max)));
}

/// Common properties of a section's rows.
struct RowGroup {
  std::string section;
  std::optional<bool> objective = {}, images = {};  // see OptionInfo
  std::optional<Method> method = {};
};

/// Collects the rows described by a stage's options. `stage` returns these options from
/// PipelineOptions, const or not. Each function returns its row.
template <typename Stage>
class OptionRows {
 public:
  OptionRows(std::vector<OptionInfo>& table, RowGroup of, Stage stage)
      : group(std::move(of)), table_(table), stage_(stage) {}

  RowGroup group;  // applies to the following rows

  /// Kind `whole` if the member is an int.
  template <typename Options, typename T>
  OptionInfo& number(const std::string& name,
                     const char* title,
                     const char* unit,
                     const char* meaning,
                     T Options::*field,
                     OptionRange range = {}) {
    constexpr bool kWhole = std::is_same_v<T, int>;
    OptionInfo& row =
        add(name, title, unit, meaning, kWhole ? OptionKind::whole : OptionKind::number);
    row.range = range;
    row.get = [of = stage_, field](const PipelineOptions& o) {
      return fmt::format("{}", of(o).*field);
    };
    row.set = [of = stage_, field, range, name](PipelineOptions& o, const std::string& text) {
      T value{};
      if constexpr (kWhole)
        value = parse_integer(text, "option " + name);
      else
        value = parse_number(text, "option " + name);
      check_range(value, range, name);
      of(o).*field = value;
    };
    return row;
  }

  template <typename Options>
  OptionInfo& flag(const std::string& name,
                   const char* title,
                   const char* meaning,
                   bool Options::*field) {
    OptionInfo& row = add(name, title, "on/off", meaning, OptionKind::on_off);
    row.get = [of = stage_, field](const PipelineOptions& o) {
      return std::string(of(o).*field ? "on" : "off");
    };
    row.set = [of = stage_, field, name](PipelineOptions& o, const std::string& text) {
      if (text == "on" || text == "true" || text == "1" || text == "yes")
        of(o).*field = true;
      else if (text == "off" || text == "false" || text == "0" || text == "no")
        of(o).*field = false;
      else
        throw Error(fmt::format("option {}: unknown value '{}'; expected on or off", name, text));
    };
    return row;
  }

  /// `values[i]` is the text of the enum's i-th value.
  template <typename Options, typename T>
  OptionInfo& choice(const std::string& name,
                     const char* title,
                     const std::vector<std::string>& values,
                     const char* meaning,
                     T Options::*field) {
    OptionInfo& row =
        add(name, title, fmt::format("{}", fmt::join(values, "/")), meaning, OptionKind::choice);
    row.choices = values;
    row.get = [of = stage_, field, values](const PipelineOptions& o) {
      return values.at(static_cast<std::size_t>(of(o).*field));
    };
    row.set = [of = stage_, field, values, name](PipelineOptions& o, const std::string& text) {
      const auto found = std::ranges::find(values, text);
      if (found == values.end())
        throw Error(fmt::format("option {}: unknown value '{}'; expected {}", name, text,
                                fmt::join(values, " or ")));
      of(o).*field = static_cast<T>(found - values.begin());
    };
    return row;
  }

 private:
  OptionInfo& add(const std::string& name,
                  const char* title,
                  const std::string& unit,
                  const char* meaning,
                  OptionKind kind) {
    table_.push_back({.name = name,
                      .title = title,
                      .unit = unit,
                      .meaning = meaning,
                      .section = group.section,
                      .kind = kind,
                      .objective = group.objective,
                      .images = group.images,
                      .method = group.method});
    return table_.back();
  }

  std::vector<OptionInfo>& table_;
  Stage stage_;
};

/// Appends the rows of a stage's options.
template <typename Stage>
void append_stage(std::vector<OptionInfo>& table, RowGroup group, Stage stage) {
  OptionRows rows(table, std::move(group), stage);
  std::decay_t<decltype(stage(std::declval<PipelineOptions&>()))>::describe(rows);
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

OptionInfo gravity_row() {
  return {.name = "gravity",
          .title = "Gravity",
          .unit = "auto/X,Y,Z/imu/estimate/none",
          .meaning =
              "Gravity direction in the frame of the sensor or cloud; none: do not distinguish "
              "horizontal from vertical",
          .section = "gravity",
          .get = [](const PipelineOptions& o) { return gravity_text(o.gravity); },
          .set =
              [](PipelineOptions& o, const std::string& text) {
                const GravityOptions parsed = parse_gravity(text);
                o.gravity.mode = parsed.mode;
                o.gravity.direction = parsed.direction;
              }};
}

OptionInfo classifier_row() {
  return {.name = "classifier",
          .title = "Classifier",
          .unit = "gcn/pca/truth/FILE",
          .meaning =
              "Classifier that labels points horizontal or vertical: a network, PCA normals, or "
              "ground truth",
          .section = "classifier",
          .get = [](const PipelineOptions& o) { return o.classifier; },
          .set =
              [](PipelineOptions& o, const std::string& text) {
                if (text != "gcn" && text != "pca" && text != "truth" && !names_weights_file(text))
                  throw Error("unknown classifier '" + text +
                              "'; expected gcn, pca, truth, or a weights file");
                o.classifier = text;
              },
          .images = false,
          .method = Method::ours};
}

OptionInfo method_row() {
  std::vector<std::string> names;
  for (const Method method : built_methods()) names.push_back(to_string(method));
  return {.name = "method",
          .title = "Method",
          .unit = fmt::format("{}", fmt::join(names, "/")),
          .meaning = "Method that finds planes: ours, or one to compare with",
          .section = "method",
          .get = [](const PipelineOptions& o) { return to_string(o.method); },
          .set = [](PipelineOptions& o, const std::string& text) { o.method = parse_method(text); },
          .kind = OptionKind::choice,
          .choices = names};
}

OptionInfo profile_row() {
  return {.name = "profile",
          .title = "Profile",
          .unit = "paper/paper-closest/refined",
          .meaning = "Set all options below to the defaults of a profile",
          .section = "criteria",
          .get = [](const PipelineOptions& o) { return to_string(o.segment.profile); },
          .set = [](PipelineOptions& o,
                    const std::string& text) { o.segment = profile_options(parse_profile(text)); },
          .kind = OptionKind::choice,
          .choices = {"paper", "paper-closest", "refined"},
          .method = Method::ours};
}

std::vector<OptionInfo> make_table() {
  std::vector<OptionInfo> rows;
  append_stage(
      rows, {"cloud"}, [](auto& o) -> auto& { return o.cloud; });
  rows.push_back(gravity_row());
  append_stage(
      rows, {"gravity"}, [](auto& o) -> auto& { return o.gravity; });
  rows.push_back(classifier_row());
  append_stage(
      rows, {.section = "classifier", .images = false, .method = Method::ours},
      [](auto& o) -> auto& { return o.pca; });
  rows.push_back(method_row());
  rows.push_back(profile_row());
  append_stage(
      rows, {.section = "criteria", .method = Method::ours},
      [](auto& o) -> auto& { return o.segment; });
  append_stage(
      rows, {.section = "objective", .objective = true, .method = Method::ours},
      [](auto& o) -> auto& { return o.segment.objective; });
  const auto append_rival = [&](Method method, auto member) {
    append_stage(
        rows, {.section = "rivals", .method = method}, [member](auto& o) -> auto& {
          return o.rivals.*member;
        });
  };
  if (has_ransac()) append_rival(Method::ransac, &RivalOptions::ransac);
  append_rival(Method::region_growing, &RivalOptions::region_growing);
  append_stage(
      rows, {"foot"}, [](auto& o) -> auto& { return o.foot; });
  append_stage(
      rows, {"stairs"}, [](auto& o) -> auto& { return o.stairs; });
  return rows;
}

// ---- Removed options ----

}  // namespace

const std::vector<RemovedOptions>& removed_options() {
  static const std::vector<RemovedOptions> all = {
      {"flat",
       {"rms_criterion3", "fixed_rms_m", "theta_rms_sigmas", "theta_rms_min_m", "theta_rms_max_m"}},
      {"bow",
       {"estimate_sigma", "sigma_by_range", "sigma_percentile", "sigma_correlated",
        "sigma_min_range_m"}},
      {"reach_sigma",
       {"fixed_tau_m", "tau_sigmas", "tau_min_m", "tau_max_m", "limits_range_m",
        "r11_pixel_borders", "r11_reach_m", "r11_taus", "r11_window_px", "r11_company_taus"}},
      {"",
       {"neighbour_levels", "normal_sigma_share", "r4_fit_impure_nodes", "r6_refit",
        "r6_sure_points", "r6_sure_share", "r6_max_loss", "r8_voxel_spread", "r8_theta_rms_sigmas",
        "r8_tau_sigmas", "split_disconnected", "split_gap_m", "split_gap_spacings",
        "split_sight_cell_m", "split_behind_m", "split_behind_taus", "split_open_share"}},
      {"resolution", {"sigma_min_points"}},
      {"label_sigma", {"other_label_sigmas", "r5_reassign_shared_cells"}},
      {"merge_cost",
       {"r1_merge_by_distance", "r1_max_angle_deg", "r1_angle_sigmas", "r1_near_m",
        "r1_far_angle_deg", "r1_gap_sigmas", "r1_offset_sigmas", "r1_max_lateral_m",
        "r3_weak_candidates", "r3_sure_sigma_ang_deg", "r3_found_sigma_ang_deg", "r3_found_points",
        "r7_second_merge", "r9_join_sheets", "r9_misfit_m", "r9_step_m", "r9_step_own",
        "r9_max_angle_deg", "r9_border_px"}},
      {"plane_cost",
       {"r2_explain_away", "r2_unexplained_points", "r2_unexplained_share", "r2_other_label_tau",
        "r2_width_sigmas", "r2_density_share", "r2_contradiction_deg", "r2_kept_share"}},
      {"worth_px",
       {"r10_minor", "r10_pixels", "r10_ragged", "r10_curved", "r10_rough", "r10_calm_m"}},
      {"two_planes", {"r12_part_corners", "r12_rms_share", "r12_min_angle_deg", "r12_least_share"}},
      {"point_reach_sigma", {"leftover_rule"}},
  };
  return all;
}

// ---- Profile files ----

namespace {

constexpr const char* kSchema = "planescope.profile/1";

/// Converts to the text that OptionInfo::set expects. Throws Error if the type does not match
/// the option.
std::string value_text(const OptionInfo& info, const JsonPlace& place) {
  if (info.kind == OptionKind::on_off) return place.boolean() ? "on" : "off";
  if (!info.is_number()) return place.text();
  const double number = place.number();
  return place.json().is_number_float() ? fmt::format("{}", number) : place.json().dump();
}

Json value_json(const OptionInfo& info, const std::string& text) {
  if (info.kind == OptionKind::on_off) return text == "on";
  return info.is_number() ? Json::parse(text) : Json(text);
}

ProfileFile profile_of(const JsonPlace& place) {
  place.schema({kSchema});
  place.has_only({"schema", "base", "options"});
  ProfileFile profile;
  if (place.has("base")) profile.base = parse_profile(place.at("base").text());
  PipelineOptions options;
  options.segment = profile_options(profile.base);
  if (!place.has("options")) return profile;
  const JsonPlace named = place.at("options");
  if (!named.json().is_object()) named.fail_kind("an object");
  for (const auto& [name, value] : named.json().items()) {
    if (name == "profile")
      throw Error("option profile: not allowed in a profile file; use \"base\" instead");
    const OptionInfo& info = find_option(name);
    profile.options.emplace_back(name, value_text(info, JsonPlace(value, "option " + name)));
    info.set(options, profile.options.back().second);
  }
  return profile;
}

bool names_file(const std::string& text) {
  if (std::ranges::count(find_option("profile").choices, text) > 0) return false;
  std::error_code ignored;
  return text.find_first_of("./") != std::string::npos || fs::exists(text, ignored);
}

}  // namespace

bool is_idle(const OptionInfo& info, const PipelineOptions& options, std::optional<bool> images) {
  const bool refined = options.segment.by_objective();
  return (info.objective && *info.objective != refined) ||
         (finds_on_pixels(options) && images && info.images && *info.images != *images);
}

const std::vector<OptionInfo>& option_table() {
  static const std::vector<OptionInfo> table = make_table();
  return table;
}

const OptionInfo& find_option(const std::string& name) {
  std::vector<std::string> names;
  for (const OptionInfo& info : option_table()) {
    if (info.name == name) return info;
    names.push_back(info.name);
  }
  for (const RemovedOptions& removed : removed_options())
    if (std::ranges::count(removed.names, name) > 0)
      throw Error(fmt::format("option {} was removed in 0.2{}{}", name,
                              removed.by.empty() ? "" : "; see ", removed.by));
  const std::string near = nearest_name(name, names);
  throw Error("unknown option '" + name + "'" +
              (near.empty() ? std::string("; `planescope options` lists all options")
                            : "; did you mean '" + near + "'?"));
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
  if (info.kind == OptionKind::whole)  // whole numbers are stored as int
    return fmt::format("{}", std::lround(std::min(value, 2147483647.0)));
  if (range.min_excluded && value <= range.min)
    value = std::nextafter(range.min, std::numeric_limits<double>::infinity());
  return fmt::format("{}", value);
}

void set_option(PipelineOptions& options, const std::string& name, const std::string& value) {
  find_option(name).set(options, value);
}

ProfileFile read_profile(const fs::path& path) {
  constexpr std::uintmax_t kMostBytes = 1 << 20;
  const auto json = read_json<Json>(path, kMostBytes);
  return read_place(path, json, profile_of);
}

std::string profile_text(const ProfileFile& profile) {
  Json json;
  json["schema"] = kSchema;
  json["base"] = to_string(profile.base);
  json["options"] = Json::object();
  for (const auto& [name, value] : profile.options)
    json["options"][name] = value_json(find_option(name), value);
  return json.dump(2) + "\n";
}

void set_profile(PipelineOptions& options, const std::string& name_or_file) {
  if (!names_file(name_or_file)) {
    const std::vector<std::string>& names = find_option("profile").choices;
    if (std::ranges::count(names, name_or_file) == 0)
      throw Error(fmt::format("unknown profile '{}'; expected {}, or the path of a file",
                              name_or_file, fmt::join(names, ", ")));
    options.segment = profile_options(parse_profile(name_or_file));
    return;
  }
  const ProfileFile profile = read_profile(name_or_file);
  options.segment = profile_options(profile.base);
  for (const auto& [name, value] : profile.options) set_option(options, name, value);
}

}  // namespace planescope::planes
