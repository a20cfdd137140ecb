#include "core/planes/pipeline/removed_options.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace planescope::planes {
namespace {

constexpr RemovedOption kRemoved[] = {
    {"rms_criterion3", "flat"},
    {"estimate_sigma", "bow"},
    {"sigma_by_range", "bow"},
    {"fixed_rms_m", "flat"},
    {"fixed_tau_m", "reach_sigma"},
    {"neighbour_levels", ""},
    {"sigma_min_points", "resolution"},
    {"sigma_percentile", "bow"},
    {"sigma_correlated", "bow"},
    {"sigma_min_range_m", "bow"},
    {"theta_rms_sigmas", "flat"},
    {"theta_rms_min_m", "flat"},
    {"theta_rms_max_m", "flat"},
    {"tau_sigmas", "reach_sigma"},
    {"tau_min_m", "reach_sigma"},
    {"tau_max_m", "reach_sigma"},
    {"limits_range_m", "reach_sigma"},
    {"other_label_sigmas", "label_sigma"},
    {"normal_sigma_share", ""},
    {"r1_merge_by_distance", "merge_cost"},
    {"r1_max_angle_deg", "merge_cost"},
    {"r1_angle_sigmas", "merge_cost"},
    {"r1_near_m", "merge_cost"},
    {"r1_far_angle_deg", "merge_cost"},
    {"r1_gap_sigmas", "merge_cost"},
    {"r1_offset_sigmas", "merge_cost"},
    {"r1_max_lateral_m", "merge_cost"},
    {"r2_explain_away", "plane_cost"},
    {"r2_unexplained_points", "plane_cost"},
    {"r2_unexplained_share", "plane_cost"},
    {"r2_other_label_tau", "plane_cost"},
    {"r2_width_sigmas", "plane_cost"},
    {"r2_density_share", "plane_cost"},
    {"r2_contradiction_deg", "plane_cost"},
    {"r2_kept_share", "plane_cost"},
    {"r3_weak_candidates", "merge_cost"},
    {"r3_sure_sigma_ang_deg", "merge_cost"},
    {"r3_found_sigma_ang_deg", "merge_cost"},
    {"r3_found_points", "merge_cost"},
    {"r4_fit_impure_nodes", ""},
    {"r5_reassign_shared_cells", "label_sigma"},
    {"r6_refit", ""},
    {"r6_sure_points", ""},
    {"r6_sure_share", ""},
    {"r6_max_loss", ""},
    {"r7_second_merge", "merge_cost"},
    {"r8_voxel_spread", ""},
    {"r8_theta_rms_sigmas", ""},
    {"r8_tau_sigmas", ""},
    {"r9_join_sheets", "merge_cost"},
    {"r9_misfit_m", "merge_cost"},
    {"r9_step_m", "merge_cost"},
    {"r9_step_own", "merge_cost"},
    {"r9_max_angle_deg", "merge_cost"},
    {"r9_border_px", "merge_cost"},
    {"r10_minor", "worth_px"},
    {"r10_pixels", "worth_px"},
    {"r10_ragged", "worth_px"},
    {"r10_curved", "worth_px"},
    {"r10_rough", "worth_px"},
    {"r10_calm_m", "worth_px"},
    {"r11_pixel_borders", "reach_sigma"},
    {"r11_reach_m", "reach_sigma"},
    {"r11_taus", "reach_sigma"},
    {"r11_window_px", "reach_sigma"},
    {"r11_company_taus", "reach_sigma"},
    {"r12_part_corners", "two_planes"},
    {"r12_rms_share", "two_planes"},
    {"r12_min_angle_deg", "two_planes"},
    {"r12_least_share", "two_planes"},
    {"split_disconnected", ""},
    {"split_gap_m", ""},
    {"split_gap_spacings", ""},
    {"split_sight_cell_m", ""},
    {"split_behind_m", ""},
    {"split_behind_taus", ""},
    {"split_open_share", ""},
    {"leftover_rule", "point_reach_sigma"},
};

}  // namespace

std::span<const RemovedOption> removed_options() { return kRemoved; }

std::string removed_text(std::string_view kind,
                         std::string_view name,
                         std::span<const RemovedOption> removed) {
  const auto row = std::ranges::find(removed, name, &RemovedOption::name);
  if (row == removed.end()) return "";
  return fmt::format("{} {} was removed in {}{}{}", kind, name, row->version,
                     row->see.empty() ? "" : "; see ", row->see);
}

}  // namespace planescope::planes
