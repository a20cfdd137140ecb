// Single steps, rows of steps, and the reasons why two levels do not form a step.

#include "core/planes/stairs/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/planes/stairs/stairs.hpp"

namespace planescope::planes {
namespace {

constexpr double kStraightM = 0.03;     // a border within this distance is on the line
constexpr double kStraightShare = 0.6;  // ... for at least this share of its width
constexpr double kReachM = 0.3;         // distance before and behind a nosing over which heights
                                        // are averaged
constexpr double kGoesOn = 0.5;         // smallest share of a step's width that the next step
                                        // must cover
constexpr int kStages = 4;              // values of Miss::stage before a step is found

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Gap between two levels along one cut.
struct Meeting {
  double across = 0;
  double front = 0;  // where the upper level begins
  double gap = 0;    // distance from the end of the lower level
  double upper_depth = 0, lower_depth = 0;
};

double width_of(std::span<const Meeting> meetings) {
  return static_cast<double>(meetings.size()) * kCutM;
}

std::vector<Meeting> meetings_of(const Cuts& lower, const Cuts& upper) {
  std::vector<Meeting> meetings;
  for (int k = std::max(lower.first, upper.first); k < std::min(lower.end(), upper.end()); ++k) {
    if (upper.at(k).empty()) continue;
    const Interval& behind = upper.at(k).front();
    const Interval* before = nullptr;
    for (const Interval& interval : lower.at(k))
      if (interval.from < behind.from - kCutM) before = &interval;
    if (!before) continue;
    const double end = std::min(before->to, behind.from);
    meetings.push_back({Cuts::across(k), behind.from, behind.from - end, behind.to - behind.from,
                        end - before->from});
  }
  return meetings;
}

/// Depth of the lower level hidden from the sensor by the upper one, behind its nosing [m].
double hidden_m(const Approach& approach, double front, double lower_z, double upper_z) {
  if (!approach.sensor) return 0;
  const double s = approach.heading.along.dot(approach.sensor->head<2>());
  const double above = approach.sensor->z() - upper_z;
  return s > front && above > 0 ? (s - front) * (upper_z - lower_z) / above : 0;
}

struct Line {
  double at = 0, slope = 0;
};

/// Theil-Sen: median of slopes, then of offsets; then least squares of the points on the line.
Line line_through(const std::vector<Meeting>& meetings) {
  constexpr std::size_t kMost = 40;
  const std::size_t stride = (meetings.size() + kMost - 1) / kMost;
  std::vector<double> slopes, offsets;
  for (std::size_t i = 0; i < meetings.size(); i += stride)
    for (std::size_t j = i + stride; j < meetings.size(); j += stride)
      slopes.push_back((meetings[j].front - meetings[i].front) /
                       (meetings[j].across - meetings[i].across));
  Line line{0, slopes.empty() ? 0 : median(std::move(slopes))};
  for (const Meeting& m : meetings) offsets.push_back(m.front - line.slope * m.across);
  line.at = median(std::move(offsets));

  double n = 0, t = 0, s = 0, tt = 0, ts = 0;
  for (const Meeting& m : meetings) {
    if (std::abs(m.front - line.at - line.slope * m.across) > kStraightM) continue;
    n += 1, t += m.across, s += m.front;
    tt += m.across * m.across, ts += m.across * m.front;
  }
  if (const double spread = n * tt - t * t; n > 2 && spread > 0) {
    line.slope = (n * ts - t * s) / spread;
    line.at = (s - line.slope * t) / n;
  }
  return line;
}

/// Mean height of a level beside a nosing, behind or before it: of the piece with the largest
/// part there.
double height_beside(const Approach& approach, int level, const SingleStep& step, bool behind) {
  const std::vector<LevelPiece>& pieces = approach.levels[level].pieces;
  double height = approach.levels[level].z_m, longest = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Cuts& cuts = approach.of_pieces[level][p];
    double length = 0, heights = 0;
    for (int k = cuts.first; k < cuts.end(); ++k) {
      const double t = Cuts::across(k), nosing = step.along(t);
      if (t < step.right || t > step.left) continue;
      for (const Interval& interval : cuts.at(k)) {
        const double from = std::max(interval.from, behind ? nosing : nosing - kReachM);
        const double to = std::min(interval.to, behind ? nosing + kReachM : nosing);
        if (from >= to) continue;
        length += to - from;
        heights += (to - from) * pieces[p].z_at(approach.heading.place((from + to) / 2, t));
      }
    }
    if (length > longest) longest = length, height = heights / length;
  }
  return height;
}

StepDecision no_step(
    std::span<const Level> levels, int lower, int upper, NoStep why, double value, double limit) {
  return {levels[lower].pieces[0].id, levels[upper].pieces[0].id, why, value, limit};
}

/// The limit that `value` violates.
double beyond(double value, double least, double most) { return value < least ? least : most; }

}  // namespace

Approach approach_along(const Heading& heading,
                        std::span<const Level> levels,
                        const std::optional<Vec3d>& sensor,
                        const StairsOptions& options) {
  Approach approach{heading, levels, {}, {}, sensor};
  for (const Level& level : levels) {
    approach.cuts.push_back(cuts_of(level, heading, options.gap_m));
    std::vector<Cuts>& pieces = approach.of_pieces.emplace_back();
    for (const LevelPiece& piece : level.pieces) pieces.push_back(cuts_of(piece.rings, heading, 0));
  }
  return approach;
}

TriedStep try_step(
    int lower, int upper, bool one_unseen, const Approach& approach, const StairsOptions& options) {
  const double lower_z = approach.levels[lower].z_m, upper_z = approach.levels[upper].z_m;
  const auto fails = [&](int stage, NoStep why, double value, double limit) {
    return TriedStep{{}, {no_step(approach.levels, lower, upper, why, value, limit), stage}};
  };
  const double rise_share = one_unseen ? 0.5 : 1;
  std::vector<Meeting> meetings = meetings_of(approach.cuts[lower], approach.cuts[upper]);
  if (width_of(meetings) < options.width_min_m)
    return fails(0, NoStep::narrow, width_of(meetings), options.width_min_m);

  const auto limit = [&](const Meeting& m) {
    return options.gap_m + hidden_m(approach, m.front, lower_z, upper_z) +
           (one_unseen ? options.going_max_m : 0);
  };
  std::vector<double> gaps, limits;
  for (const Meeting& m : meetings) gaps.push_back(m.gap), limits.push_back(limit(m));
  const double median_limit = median(std::move(limits)), median_gap = median(std::move(gaps));
  std::erase_if(meetings, [&](const Meeting& m) {
    return m.gap > limit(m) || (one_unseen && m.gap < options.going_min_m);
  });
  if (width_of(meetings) < options.width_min_m)
    return fails(1, NoStep::apart, median_gap, median_limit);
  if (const double rise_m = rise_share * (upper_z - lower_z);
      rise_m > 2 * options.rise_max_m || rise_m < options.rise_min_m / 2)
    return fails(2, NoStep::rise, rise_m, beyond(rise_m, options.rise_min_m, options.rise_max_m));

  const Line line = line_through(meetings);
  const auto is_on = [&](double front, double across) {
    return std::abs(front - line.at - line.slope * across) <= kStraightM;
  };
  const double facing_m = width_of(meetings);
  std::erase_if(meetings, [&](const Meeting& m) { return !is_on(m.front, m.across); });
  if (width_of(meetings) < kStraightShare * facing_m)
    return fails(3, NoStep::crooked, width_of(meetings) / facing_m, kStraightShare);
  if (std::abs(std::atan(line.slope)) * kDegrees > options.turn_deg ||
      width_of(meetings) < options.width_min_m)
    return fails(0, NoStep::narrow, width_of(meetings), options.width_min_m);

  SingleStep step{.lower = lower, .upper = upper, .one_unseen = one_unseen};
  step.at = line.at, step.slope = line.slope;
  const Cuts& cuts = approach.cuts[upper];
  step.right = meetings.front().across - kCutM / 2, step.left = meetings.back().across + kCutM / 2;
  for (int k = cuts.first; k < cuts.end(); ++k) {
    const double t = Cuts::across(k);
    if (cuts.at(k).empty() || !is_on(cuts.at(k).front().from, t)) continue;
    step.right = std::min(step.right, t - kCutM / 2),
    step.left = std::max(step.left, t + kCutM / 2);
  }
  std::vector<double> upper_depths, lower_depths;
  for (const Meeting& m : meetings) {
    upper_depths.push_back(m.upper_depth);
    lower_depths.push_back(m.lower_depth);
  }
  step.upper_depth_m = median(std::move(upper_depths));
  step.lower_depth_m = median(std::move(lower_depths));
  step.rise_m = rise_share * (height_beside(approach, upper, step, true) -
                              height_beside(approach, lower, step, false));
  if (step.rise_m < options.rise_min_m || step.rise_m > options.rise_max_m)
    return fails(kStages, NoStep::rise, step.rise_m,
                 beyond(step.rise_m, options.rise_min_m, options.rise_max_m));
  return {step, {}};
}

int StepRow::unseen() const {
  return static_cast<int>(std::ranges::count(steps, true, &SingleStep::one_unseen));
}
int StepRow::count() const { return static_cast<int>(steps.size()) + unseen(); }

bool StepRow::operator<(const StepRow& other) const {
  if (count() != other.count()) return count() < other.count();
  if (unseen() != other.unseen()) return unseen() > other.unseen();
  return uneven_m > other.uneven_m;
}

double going_between(const SingleStep& last, const SingleStep& next) {
  const double across = (std::max(last.right, next.right) + std::min(last.left, next.left)) / 2;
  const double mean_slope = (last.slope + next.slope) / 2;
  return (next.along(across) - last.along(across)) / std::sqrt(1 + mean_slope * mean_slope) /
         (next.one_unseen ? 2 : 1);
}

std::optional<StepDecision> misfit(const SingleStep& last,
                                   const SingleStep& next,
                                   std::optional<double> going_m,
                                   std::span<const Level> levels,
                                   const StairsOptions& options) {
  const auto no = [&](NoStep why, double value, double limit) {
    return no_step(levels, next.lower, next.upper, why, value, limit);
  };
  const double shared = std::min(last.left, next.left) - std::max(last.right, next.right);
  const double least = std::max(options.width_min_m, kGoesOn * (last.left - last.right));
  if (shared < least) return no(NoStep::narrow, shared, least);
  const double going = going_between(last, next);
  if (going < options.going_min_m || going > options.going_max_m)
    return no(NoStep::going, going, beyond(going, options.going_min_m, options.going_max_m));
  if (const double differs = std::abs(next.rise_m - last.rise_m); differs > options.rise_spread_m)
    return no(NoStep::rise_uneven, differs, options.rise_spread_m);
  if (const double differs = std::abs(going - going_m.value_or(going));
      differs > options.going_spread_m)
    return no(NoStep::going_uneven, differs, options.going_spread_m);
  return {};
}

StepRow longest_row(std::span<const SingleStep> steps,
                    std::span<const Level> levels,
                    const StairsOptions& options) {
  // Levels are sorted by height, so a step comes after all steps that lead up to it.
  std::vector<SingleStep> ordered(steps.begin(), steps.end());
  std::ranges::stable_sort(ordered, {}, &SingleStep::upper);
  std::vector<StepRow> ending(ordered.size());  // the best row ending with this step
  StepRow best;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const bool one_unseen = ordered[i].one_unseen;
    if (!one_unseen) ending[i].steps = {ordered[i]};
    for (std::size_t j = 0; j < i; ++j) {
      const StepRow& before = ending[j];
      if (ordered[j].upper != ordered[i].lower || levels[ordered[i].lower].minor ||
          before.steps.empty() || (one_unseen && ordered[j].one_unseen))
        continue;
      std::optional<double> going_m;
      if (before.steps.size() > 1)
        going_m = going_between(before.steps[before.steps.size() - 2], before.steps.back());
      if (misfit(ordered[j], ordered[i], going_m, levels, options)) continue;
      StepRow row = before;
      row.steps.push_back(ordered[i]);
      row.uneven_m += std::abs(ordered[i].rise_m - ordered[j].rise_m);
      if (going_m) row.uneven_m += std::abs(going_between(ordered[j], ordered[i]) - *going_m);
      if (ending[i] < row) ending[i] = std::move(row);
    }
    const StepRow& row = ending[i];
    const auto listed = std::ranges::count_if(row.steps, [&](const SingleStep& step) {
      return !step.one_unseen && !levels[step.lower].minor && !levels[step.upper].minor;
    });
    if (row.count() - 2 * row.unseen() >= 2 && listed > 0 && best < row) best = row;
  }
  return best;
}

// ---- Text ----

namespace {

std::string cm(double m) { return fmt::format("{:.0f} cm", 100 * m); }

std::string reason_of(const StepDecision& d) {
  switch (d.why) {
    case NoStep::rise:
      return fmt::format("no step: rise {}, limit {}", cm(d.value), cm(d.limit));
    case NoStep::apart:
      return fmt::format("no step: {} apart, limit {}", cm(d.value), cm(d.limit));
    case NoStep::narrow:
      return fmt::format("no step: {} wide, limit {}", cm(d.value), cm(d.limit));
    case NoStep::crooked:
      return fmt::format("no step: only {:.0f} % of the border is straight, limit {:.0f} %",
                         100 * d.value, 100 * d.limit);
    case NoStep::rise_uneven:
      return fmt::format("not part of the flight below: rises differ by {}, limit {}", cm(d.value),
                         cm(d.limit));
    case NoStep::going:
      return fmt::format("not part of the flight below: going {}, limit {}", cm(d.value),
                         cm(d.limit));
    case NoStep::going_uneven:
      return fmt::format("not part of the flight below: goings differ by {}, limit {}", cm(d.value),
                         cm(d.limit));
    case NoStep::alone:
      return fmt::format("single step: {} wide, limit for a kerb {}", cm(d.value), cm(d.limit));
    case NoStep::shallow:
      break;
  }
  return fmt::format("single step: {} deep, limit for a kerb {}", cm(d.value), cm(d.limit));
}

}  // namespace

const char* to_string(NoStep why) {
  switch (why) {
    case NoStep::rise:
      return "rise";
    case NoStep::apart:
      return "apart";
    case NoStep::narrow:
      return "narrow";
    case NoStep::crooked:
      return "crooked";
    case NoStep::rise_uneven:
      return "rise_uneven";
    case NoStep::going:
      return "going";
    case NoStep::going_uneven:
      return "going_uneven";
    case NoStep::alone:
      return "alone";
    case NoStep::shallow:
      break;
  }
  return "shallow";
}

std::string to_text(const StepDecision& decision) {
  return fmt::format("P{} -> P{} {}", decision.lower, decision.upper, reason_of(decision));
}

}  // namespace planescope::planes
