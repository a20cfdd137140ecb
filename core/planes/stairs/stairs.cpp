// Finds flights, kerbs and ramps between the levels of a frame.

#include "core/planes/stairs/stairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "core/planes/stairs/levels.hpp"
#include "core/planes/stairs/steps.hpp"

namespace planescope::planes {
namespace {

constexpr double kSameHeadingDeg = 30;

double angle_deg(const Vec2d& a, const Vec2d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * kDegrees;
}

/// Input of the search in one frame.
struct Scene {
  const CoveringPlanes& all;
  std::optional<Vec3d> sensor;
  const StairsOptions& options;
  LevelPlanesOf found;
};

/// All steps up in one direction, and the near misses.
struct StepsAlong {
  Approach approach;
  std::vector<SingleStep> steps;
  std::vector<Miss> misses;
};

StepsAlong steps_along(const Heading& heading, const Scene& scene) {
  StepsAlong along{
      approach_along(heading, scene.found.levels, scene.sensor, scene.options), {}, {}};
  const int levels = static_cast<int>(scene.found.levels.size());
  for (int lower = 0; lower < levels; ++lower)
    for (int upper = lower + 1; upper < levels; ++upper)
      for (const bool one_unseen : {false, true}) {
        const bool lower_minor = scene.found.levels[lower].minor;
        const bool upper_minor = scene.found.levels[upper].minor;
        if ((lower_minor && upper_minor) || (one_unseen && (lower_minor || upper_minor))) continue;
        TriedStep tried = try_step(lower, upper, one_unseen, along.approach, scene.options);
        if (tried.step)
          along.steps.push_back(*tried.step);
        else if (!one_unseen && !lower_minor)
          along.misses.push_back(tried.miss);
      }
  return along;
}

Vec3d on_level(const Vec2d& xy, double z) { return {xy.x(), xy.y(), z}; }

/// Id of the largest plane below a nosing, 0 if none.
int riser_below(const NosingLine& nosing, double rise_m, const Vec2d& uphill, const Scene& scene) {
  constexpr double kNearM = 0.06, kMostTurnDeg = 15;
  const Vec2d middle = (nosing.right + nosing.left).head<2>() / 2;
  const Vec2d across(-uphill.y(), uphill.x());
  int best = 0;
  double best_m2 = 0;
  for (std::size_t i = 0; i < scene.all.planes.size(); ++i) {
    const Outline& outline = scene.all.outlines[i];
    const Vec3d& normal = scene.all.planes[i].fit.normal;
    if (scene.all.planes[i].label != Label::v || outline.area_m2 <= best_m2) continue;
    const Vec2d facing = normal.head<2>().normalized();
    const double turn_deg = angle_deg(facing, uphill);
    if (std::min(turn_deg, 180 - turn_deg) > kMostTurnDeg) continue;
    const Vec2d from_middle = outline.origin.head<2>() - middle;
    const double z = nosing.left.z() - outline.origin.z();
    if (std::abs(facing.dot(from_middle)) > kNearM || z < -kNearM || z > rise_m + kNearM ||
        std::abs(across.dot(from_middle)) > nosing.width_m() / 2)
      continue;
    best = scene.all.planes[i].id;
    best_m2 = outline.area_m2;
  }
  return best;
}

NosingLine nosing_of(const SingleStep& step, const Approach& approach) {
  const double z = approach.levels[step.upper].z_m;
  const auto end = [&](double across) {
    return on_level(approach.heading.place(step.along(across), across), z);
  };
  return {end(step.right), end(step.left)};
}

// ---- Flights ----

struct Found {
  Approach approach;
  StepRow row;
};

/// The heading perpendicular to the nosings.
Heading straightened(const Found& found) {
  double slope = 0, width = 0;
  for (const SingleStep& step : found.row.steps) {
    slope += step.slope * step.width_m();
    width += step.width_m();
  }
  slope /= width;
  const Heading& heading = found.approach.heading;
  return {Vec2d(heading.along - slope * heading.across()).normalized()};
}

Found best_flight(std::vector<StepsAlong>& directions,
                  const std::set<int>& taken,
                  const Scene& scene) {
  const auto row_of = [&](const StepsAlong& along) {
    std::vector<SingleStep> free;
    for (const SingleStep& step : along.steps)
      if (!taken.contains(step.upper)) free.push_back(step);
    return longest_row(free, scene.found.levels, scene.options);
  };
  Found best;
  for (const StepsAlong& along : directions)
    if (StepRow row = row_of(along); best.row < row) best = {along.approach, std::move(row)};
  for (int round = 0; round < 2 && !best.row.steps.empty(); ++round) {
    StepsAlong along = steps_along(straightened(best), scene);
    StepRow row = row_of(along);
    if (row.count() < best.row.count()) break;
    best = {std::move(along.approach), std::move(row)};
  }
  return best;
}

SeenFrom seen_from(const Found& found) {
  const std::optional<Vec3d>& sensor = found.approach.sensor;
  if (!sensor) return SeenFrom::unknown;
  const SingleStep &first = found.row.steps.front(), &last = found.row.steps.back();
  const Heading& heading = found.approach.heading;
  const double across = heading.across().dot(sensor->head<2>());
  const double middle = (first.along(across) + last.along(across)) / 2;
  return heading.along.dot(sensor->head<2>()) < middle ? SeenFrom::below : SeenFrom::above;
}

/// Position of a riser along the heading, at a position across it.
double along_riser(int riser, const Heading& heading, double across, const Scene& scene) {
  const std::size_t i = static_cast<std::size_t>(riser) - 1;
  const Vec2d normal = scene.all.planes[i].fit.normal.head<2>();
  const Vec2d origin = scene.all.outlines[i].origin.head<2>();
  return heading.along.dot(origin) - (across - heading.across().dot(origin)) *
                                         normal.dot(heading.across()) / normal.dot(heading.along);
}

/// Distance to the next step: between risers if both were seen, else between nosings.
double going_m(const Flight::Step& last,
               const Flight::Step& next,
               const Heading& heading,
               const Scene& scene) {
  const auto along = [&](const Flight::Step& step, double across) {
    if (last.riser > 0 && next.riser > 0) return along_riser(step.riser, heading, across, scene);
    const Vec2d right = step.nosing.right.head<2>(), left = step.nosing.left.head<2>();
    const double from = heading.across().dot(right), to = heading.across().dot(left);
    return heading.along.dot(Vec2d(right + (left - right) * (across - from) / (to - from)));
  };
  const Vec2d middle =
      (last.nosing.right + last.nosing.left + next.nosing.right + next.nosing.left).head<2>() / 4;
  const double across = heading.across().dot(middle);
  return along(next, across) - along(last, across);
}

Flight flight_of(const Found& found, const Scene& scene) {
  const std::vector<SingleStep>& steps = found.row.steps;
  const std::vector<Level>& levels = scene.found.levels;
  const Vec2d along = found.approach.heading.along;
  Flight flight;
  flight.uphill = {along.x(), along.y(), 0};
  flight.foot = levels[steps.front().lower].ids();
  std::vector<double> widths;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SingleStep& step = steps[i];
    Flight::Step seen_step{levels[step.upper].ids(), 0, step.rise_m, 0,
                           nosing_of(step, found.approach)};
    if (step.one_unseen) {
      Flight::Step unseen = seen_step;
      unseen.tread.clear();
      const Vec3d down = on_level(-going_between(steps[i - 1], step) * along, -step.rise_m);
      unseen.nosing = {seen_step.nosing.right + down, seen_step.nosing.left + down};
      flight.steps.push_back(unseen);
    }
    widths.push_back(step.width_m());
    flight.steps.push_back(std::move(seen_step));
  }
  double goings = 0, rises = 0;
  for (std::size_t i = 0; i < flight.steps.size(); ++i) {
    Flight::Step& step = flight.steps[i];
    step.riser = riser_below(step.nosing, step.rise_m, along, scene);
    rises += step.rise_m;
    if (i > 0)
      goings += step.going_m = going_m(flight.steps[i - 1], step, found.approach.heading, scene);
  }
  const auto count = static_cast<double>(flight.steps.size());
  flight.rise_m = rises / count;
  flight.going_m = goings / (count - 1);
  std::ranges::sort(widths);
  flight.width_m = widths[widths.size() / 2];
  flight.seen = seen_from(found);
  flight.landing = steps.back().upper_depth_m > scene.options.landing_goings * flight.going_m;
  return flight;
}

// ---- Single steps ----

bool is_minor(const SingleStep& step, const Scene& scene) {
  return scene.found.levels[step.lower].minor || scene.found.levels[step.upper].minor;
}

/// A step that is not part of a flight.
struct Single {
  SingleStep step;
  const StepsAlong* along = nullptr;
};

/// Reason why a single step is not a kerb; nullopt if it is one.
std::optional<StepDecision> no_kerb(const SingleStep& step, const Scene& scene) {
  const auto no = [&](NoStep why, double value, double limit) {
    return StepDecision{scene.found.levels[step.lower].pieces[0].id,
                        scene.found.levels[step.upper].pieces[0].id, why, value, limit};
  };
  const StairsOptions& options = scene.options;
  if (step.width_m() < options.kerb_width_m)
    return no(NoStep::alone, step.width_m(), options.kerb_width_m);
  const double depth_m = std::min(step.lower_depth_m, step.upper_depth_m);
  if (depth_m < options.kerb_depth_m) return no(NoStep::shallow, depth_m, options.kerb_depth_m);
  return {};
}

std::vector<Single> kerbs_among(const std::vector<StepsAlong>& directions,
                                const std::vector<std::set<int>>& flights,
                                const Scene& scene) {
  std::vector<Single> singles;
  for (const StepsAlong& along : directions)
    for (const SingleStep& step : along.steps) {
      const auto has_both = [&](const std::set<int>& levels) {
        return levels.contains(step.lower) && levels.contains(step.upper);
      };
      if (step.one_unseen || is_minor(step, scene) || std::ranges::any_of(flights, has_both) ||
          no_kerb(step, scene))
        continue;
      singles.push_back({step, &along});
    }
  // If several headings find the same nosing, keep the one most perpendicular to it.
  std::ranges::stable_sort(singles, {}, [](const Single& s) {
    return std::tuple(s.step.upper, s.step.lower, std::abs(s.step.slope));
  });
  std::vector<Single> kept;
  for (const Single& single : singles) {
    const auto same = [&](const Single& other) {
      return other.step.upper == single.step.upper && other.step.lower == single.step.lower &&
             angle_deg(other.along->approach.heading.along, single.along->approach.heading.along) <
                 kSameHeadingDeg;
    };
    if (std::ranges::none_of(kept, same)) kept.push_back(single);
  }
  return kept;
}

Kerb kerb_of(const Single& single, const Scene& scene) {
  const SingleStep& step = single.step;
  const Heading& heading = single.along->approach.heading;
  Kerb kerb;
  kerb.lower = scene.found.levels[step.lower].ids();
  kerb.upper = scene.found.levels[step.upper].ids();
  kerb.rise_m = step.rise_m;
  kerb.nosing = nosing_of(step, single.along->approach);
  const Vec2d uphill = Vec2d(heading.along - step.slope * heading.across()).normalized();
  kerb.uphill = {uphill.x(), uphill.y(), 0};
  kerb.riser = riser_below(kerb.nosing, kerb.rise_m, uphill, scene);
  return kerb;
}

// ---- Floor and near misses ----

/// The lowest level of at least floor_m2, else the largest level; null if there are none.
const Level* floor_of(std::span<const Level> levels, const StairsOptions& options) {
  const Level* floor = nullptr;
  for (const Level& level : levels) {
    if (level.minor) continue;
    if (level.area_m2 >= options.floor_m2) return &level;
    if (!floor || level.area_m2 > floor->area_m2) floor = &level;
  }
  return floor;
}

/// For each level without a step up to it, the nearest miss.
std::vector<StepDecision> decisions_of(const std::vector<StepsAlong>& directions,
                                       const std::set<int>& reached,
                                       const Scene& scene) {
  const std::vector<Level>& levels = scene.found.levels;
  std::vector<StepDecision> decisions;
  for (int upper = 0; upper < static_cast<int>(levels.size()); ++upper) {
    if (reached.contains(upper) || levels[upper].minor) continue;
    Miss nearest{{}, -1};
    const auto consider = [&](const Miss& miss) {
      if (miss.stage > nearest.stage ||
          (miss.stage == nearest.stage &&
           std::abs(miss.decision.value - miss.decision.limit) <
               std::abs(nearest.decision.value - nearest.decision.limit)))
        nearest = miss;
    };
    for (const StepsAlong& along : directions) {
      for (const Miss& miss : along.misses)
        if (miss.decision.upper == levels[upper].pieces[0].id) consider(miss);
      for (const SingleStep& step : along.steps) {
        if (step.upper != upper || step.one_unseen || is_minor(step, scene)) continue;
        constexpr int kSteps = 10;
        for (const SingleStep& below : along.steps)
          if (below.upper == step.lower)
            if (const auto why = misfit(below, step, {}, levels, scene.options))
              consider({*why, kSteps + 1});
        if (const auto why = no_kerb(step, scene)) consider({*why, kSteps});
      }
    }
    if (nearest.stage > 0) decisions.push_back(nearest.decision);
  }
  return decisions;
}

}  // namespace

Stairs find_stairs(const CoveringPlanes& found,
                   const CoveringPlanes& minor,
                   const std::optional<Vec3d>& sensor,
                   const StairsOptions& options) {
  Scene scene{found, sensor, options, levels_of(found, minor, options)};
  const std::vector<Level>& levels = scene.found.levels;
  Stairs stairs;
  stairs.height_m.assign(found.planes.size(), std::numeric_limits<double>::quiet_NaN());
  const Level* floor = floor_of(levels, options);
  if (!floor) return stairs;
  stairs.floor = floor->pieces[0].id;
  for (const Level& level : levels)
    for (const LevelPiece& piece : level.pieces)
      if (!level.minor)
        stairs.height_m[static_cast<std::size_t>(piece.id) - 1] =
            piece.centroid.z() - floor->pieces[0].centroid.z();

  std::vector<StepsAlong> directions;
  for (const Heading& heading : headings_of(levels, found))
    directions.push_back(steps_along(heading, scene));
  std::set<int> reached;                 // levels that a step of a flight or a kerb leads up to
  std::vector<std::set<int>> of_flight;  // levels
  for (;;) {
    const Found flight = best_flight(directions, reached, scene);
    if (flight.row.steps.empty()) break;
    std::set<int>& own = of_flight.emplace_back();
    for (const SingleStep& step : flight.row.steps) {
      own.insert({step.lower, step.upper});
      reached.insert(step.upper);
    }
    stairs.flights.push_back(flight_of(flight, scene));
  }
  for (const Single& single : kerbs_among(directions, of_flight, scene)) {
    stairs.kerbs.push_back(kerb_of(single, scene));
    reached.insert(single.step.upper);
  }
  for (const LevelPiece& piece : scene.found.tilted)
    if (auto ramp = ramp_of(piece, levels, options)) stairs.ramps.push_back(std::move(*ramp));
  stairs.decisions = decisions_of(directions, reached, scene);
  return stairs;
}

}  // namespace planescope::planes
