#pragma once

// Single steps, from one level to a higher one, and rows of them. Internal to core/planes/stairs.

#include <optional>
#include <span>
#include <vector>

#include "core/planes/stairs/levels.hpp"

namespace planescope::planes {

/// Levels as who goes in one direction meets them.
struct Approach {
  Heading heading;
  std::span<const Level> levels;
  std::vector<Cuts> cuts;  // of each level
  std::vector<std::vector<Cuts>> of_pieces;
  std::optional<Vec3d> sensor;
};
Approach approach_along(const Heading& heading,
                        std::span<const Level> levels,
                        const std::optional<Vec3d>& sensor,
                        const StairsOptions& options);

/// From a level to a higher one, over a nosing that is a line: along = at + slope * across.
struct SingleStep {
  int lower = 0, upper = 0;  // levels
  bool one_unseen = false;   // two steps: the tread between was not seen
  double rise_m = 0;         // of each of them
  double at = 0, slope = 0;
  double right = 0, left = 0;  // where the nosing ends, across
  double upper_depth_m = 0;    // of the upper level behind the nosing, median
  double lower_depth_m = 0;    // of the lower level before it
  double along(double across) const { return at + slope * across; }
  double width_m() const { return (left - right) * std::sqrt(1 + slope * slope); }
};

/// How far two levels are from a step: the later, the nearer.
struct Miss {
  StepDecision decision;
  int stage = 0;
};
struct TriedStep {
  std::optional<SingleStep> step;
  Miss miss;  // where there is none
};
TriedStep try_step(
    int lower, int upper, bool one_unseen, const Approach& approach, const StairsOptions& options);

/// Steps one behind the other, from the lowest.
struct StepRow {
  std::vector<SingleStep> steps;
  double uneven_m = 0;  // how much rises and goings differ from one to the next, added up
  int unseen() const;
  int count() const;                           // with those unseen
  bool operator<(const StepRow& other) const;  // fewer steps, more of them unseen, less even
};
/// Why `next` does not go on from `last`, whose going is `going_m` where that is known.
std::optional<StepDecision> misfit(const SingleStep& last,
                                   const SingleStep& next,
                                   std::optional<double> going_m,
                                   std::span<const Level> levels,
                                   const StairsOptions& options);
double going_between(const SingleStep& last, const SingleStep& next);

/// The best row of at least two steps that were seen, one of them first, where no two treads in
/// sequence were not. Minor levels are its ends alone, and one step has none. Empty: there is none.
StepRow longest_row(std::span<const SingleStep> steps,
                    std::span<const Level> levels,
                    const StairsOptions& options);

}  // namespace planescope::planes
