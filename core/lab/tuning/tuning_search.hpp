#pragma once

// Tunable options, the values to try next, and the search: from coarse steps to fine ones, one
// option at a time from the best setting so far, then the gains combined.

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/planes/pipeline/options_table.hpp"

namespace planescope::lab {

/// Options that differ from the start of the search: name, value.
using Setting = std::map<std::string, std::string>;

planes::PipelineOptions with_setting(planes::PipelineOptions options, const Setting& setting);

/// Whether the option belongs to the method: labeling of points, the voxels, criteria, objective,
/// or the numbers of a rival. Excludes options that select the scored points (range, cube), facts
/// about the recording (gravity), and the output of finished planes.
bool is_tunable(const planes::OptionInfo& info);

/// The values to try next. For a switch or choice, its other values, only if `factor` is that of
/// the coarsest step. For a number, a smaller and a larger one: `factor` times as far from the
/// nearer end of its range, and as near. Empty if the option has no effect with these options, or
/// if a number is at the only end of its range, where 0 often means "off".
std::vector<std::string> values_to_try(const planes::OptionInfo& info,
                                       const planes::PipelineOptions& options,
                                       double factor);

/// Steps from coarse to fine: 2, and its square and fourth roots.
inline constexpr double kTuningFactors[] = {2, 1.4142135623730951, 1.1892071150027210};

/// A setting and its score on each frame [%]: higher is better.
struct Trial {
  Setting setting;
  std::vector<double> scores;
};
double mean_score(const Trial& trial);

/// Difference of one trial's scores from another's, frame by frame.
struct Gain {
  double mean = 0;
  double error = 0;                      // standard error of the mean; 0 for one frame
  int better = 0, worse = 0, alike = 0;  // frames

  /// Whether more than one frame supports it: if only one gains, the mean equals its standard
  /// error. Gains below a twentieth of a point do not count.
  bool counts() const;
};
Gain gain_of(const Trial& trial, const Trial& than);

/// Thrown by `evaluate` if no more trials are allowed: the search ends with its current result.
struct TuningSpent {};

struct TuningSearch {
  planes::PipelineOptions base;      // changed by the settings
  std::vector<std::string> options;  // names of the options to search
  int trials = 0;                    // limit on trials, excluding those that revert changes
  /// Scores the settings, in their order. May throw TuningSpent if `may_end`.
  std::function<std::vector<Trial>(std::span<const Setting>, bool may_end)> evaluate;
};

/// A changed option, and the effect of reverting only it.
struct TakenBack {
  std::string option;
  Trial without;
};

struct Tuned {
  Trial base, best;
  std::vector<TakenBack> changes;  // of the best setting, the most important first
  int asked = 0;                   // trials run by the search
  bool complete = false;           // no step of any size gains more
};

/// Repeats steps of one size, then of the next. Each step tries every option alone, smaller and
/// larger, then takes the values that gain one after another, the greatest gain first, as long as
/// they still gain, until nothing does. Finally reverts changes that can be reverted without a
/// significant loss, the least loss first. Independent of how the settings are evaluated.
Tuned search_options(const TuningSearch& search);

}  // namespace planescope::lab
