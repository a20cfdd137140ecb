#pragma once

// What tuning may change, and what it tries next.

#include <map>
#include <string>
#include <vector>

#include "core/planes/pipeline/options_table.hpp"

namespace planescope::lab {

/// What is set otherwise than in the options that the search begins with: name, value.
using Setting = std::map<std::string, std::string>;

planes::PipelineOptions with_setting(planes::PipelineOptions options, const Setting& setting);

/// Whether the option is one of the method's own: how points are labelled, the voxels, criteria,
/// objective, or the numbers of a rival. Not what decides which points are scored (range, cube),
/// what is a fact about the recording (gravity), or what is told of finished planes.
bool is_tunable(const planes::OptionInfo& info);

/// The values to try from here on: the others of a switch or a choice where `factor` is that of the
/// coarsest step; of a number a smaller and a larger one, `factor` times as far from the nearer end
/// of its range, and as near. None where the option does nothing with these options, or where a
/// number stands at its range's end and the range has no other: 0 is often "not asked".
std::vector<std::string> values_to_try(const planes::OptionInfo& info,
                                       const planes::PipelineOptions& options,
                                       double factor);

/// Steps from coarse to fine: 2, and its square and fourth roots.
inline constexpr double kTuningFactors[] = {2, 1.4142135623730951, 1.1892071150027210};

}  // namespace planescope::lab
