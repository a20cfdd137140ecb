#pragma once

// Single steps from one level to a higher one, and rows of steps. Internal to core/planes/stairs.

#include <optional>
#include <span>
#include <vector>

#include "core/planes/stairs/levels.hpp"

namespace planescope::planes {

/// Levels along one heading, in cuts.
struct Approach {
  Heading heading;
  std::span<const Level> levels;
  std::vector<Cuts> cuts;  // per level
  std::vector<std::vector<Cuts>> of_pieces;
  std::optional<Vec3d> sensor;
};
Approach approach_along(const Heading& heading,
                        std::span<const Level> levels,
                        const std::optional<Vec3d>& sensor,
                        const StairsOptions& options);

/// A step between two levels, over a straight nosing: along = at + slope * across.
struct SingleStep {
  int lower = 0, upper = 0;  // levels
  bool one_unseen = false;   // two steps with an unseen tread between them
  double rise_m = 0;         // per step
  double at = 0, slope = 0;
  double right = 0, left = 0;  // ends of the nosing, across
  double upper_depth_m = 0;    // upper level behind the nosing, median
  double lower_depth_m = 0;    // lower level before the nosing
  double along(double across) const { return at + slope * across; }
  double width_m() const { return (left - right) * std::sqrt(1 + slope * slope); }
};

/// A pair of levels that is not a step. A higher stage is closer to a step.
struct Miss {
  StepDecision decision;
  int stage = 0;
};
struct TriedStep {
  std::optional<SingleStep> step;
  Miss miss;  // if there is no step
};
TriedStep try_step(
    int lower, int upper, bool one_unseen, const Approach& approach, const StairsOptions& options);

/// Consecutive steps, lowest first.
struct StepRow {
  std::vector<SingleStep> steps;
  double uneven_m = 0;  // sum of the differences of rises and goings between successive steps
  int unseen() const;
  int count() const;                           // including unseen steps
  bool operator<(const StepRow& other) const;  // fewer steps, more of them unseen, less even
};
/// Reason why `next` does not continue the row after `last`. `going_m`: going of `last`, if known.
std::optional<StepDecision> misfit(const SingleStep& last,
                                   const SingleStep& next,
                                   std::optional<double> going_m,
                                   std::span<const Level> levels,
                                   const StairsOptions& options);
double going_between(const SingleStep& last, const SingleStep& next);

/// The best row of at least two seen steps, starting with one, without two consecutive unseen
/// treads. Minor levels occur only at its ends, and at least one of its steps has none. Empty if
/// there is no such row.
StepRow longest_row(std::span<const SingleStep> steps,
                    std::span<const Level> levels,
                    const StairsOptions& options);

}  // namespace planescope::planes
