#pragma once

// What tuning may change, what it tries next, and the search: from coarse steps to fine ones, one
// option at a time from the best setting so far, and those that gain taken together.

#include <functional>
#include <map>
#include <span>
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

/// A setting and what it reached on each frame [%]: higher is better.
struct Trial {
  Setting setting;
  std::vector<double> scores;
};
double mean_score(const Trial& trial);

/// How one trial's scores stand to another's, frame by frame.
struct Gain {
  double mean = 0;
  double error = 0;                      // standard error of the mean; 0 for one frame
  int better = 0, worse = 0, alike = 0;  // frames

  /// Whether more than one frame carries it: where one alone gains, the mean is its own standard
  /// error. Gains below a twentieth of a point are none.
  bool counts() const;
};
Gain gain_of(const Trial& trial, const Trial& than);

/// Thrown by whoever evaluates, where no more trials are to be made: the search ends with what it
/// has.
struct TuningSpent {};

struct TuningSearch {
  planes::PipelineOptions base;      // that the settings change
  std::vector<std::string> options;  // names of those that are searched
  int trials = 0;                    // at most so many are asked for; what is taken back is beyond
  /// Scores the settings, in their order. May throw TuningSpent where `may_end`.
  std::function<std::vector<Trial>(std::span<const Setting>, bool may_end)> evaluate;
};

/// An option that was changed, and what taking it back alone does.
struct TakenBack {
  std::string option;
  Trial without;
};

struct Tuned {
  Trial base, best;
  std::vector<TakenBack> changes;  // of the best setting, what matters most first
  int asked = 0;                   // trials that the search made
  bool complete = false;           // no step of any size gains more
};

/// Steps of one size after the other. Of each, every option is tried alone, smaller and larger;
/// then the values that gain are taken one after the other, the greatest gain first, where they
/// still gain; again, until nothing does. In the end what can be taken back without a loss that
/// counts is taken back, the least loss first. The same for any way in which the settings are
/// evaluated.
Tuned search_options(const TuningSearch& search);

}  // namespace planescope::lab
