#include "core/planes/stairs/ramps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace planescope::planes {
namespace {

/// The level of a height that begins or ends where the ramp does.
LevelPlanes level_at_end(const Cuts& ramp,
                         const Heading& uphill,
                         double z,
                         bool upper,
                         std::span<const Level> levels,
                         const StairsOptions& options) {
  constexpr double kSameM = 0.04;
  const Level* best = nullptr;
  double best_m = 0;
  for (const Level& level : levels) {
    if (level.minor) continue;
    const Cuts cuts = cuts_of(level, uphill, options.gap_m);
    double near_m = 0;
    for (int k = ramp.first; k < ramp.end(); ++k) {
      if (ramp.at(k).empty()) continue;
      const double end = upper ? ramp.at(k).back().to : ramp.at(k).front().from;
      for (const Interval& interval : cuts.at(k)) {
        const double gap = upper ? interval.from - end : end - interval.to;
        const bool reaches_on = upper ? interval.to > end : interval.from < end;
        if (std::abs(gap) > options.gap_m || !reaches_on) continue;
        const Vec2d at = uphill.place(end, Cuts::across(k));
        if (std::abs(level.pieces[0].z_at(at) - z) > kSameM) continue;
        near_m += kCutM;
        break;
      }
    }
    if (near_m >= options.width_min_m && near_m > best_m) best = &level, best_m = near_m;
  }
  return best ? best->ids() : LevelPlanes{};
}

}  // namespace

std::optional<SlopingPlane> ramp_of(const LevelPiece& piece,
                                    std::span<const Level> levels,
                                    const StairsOptions& options) {
  const Vec2d uphill = -piece.normal.head<2>().normalized();
  const Heading heading{uphill};
  const Cuts cuts = cuts_of(piece.rings, heading, options.gap_m);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  int covered = 0;
  for (const std::vector<Interval>& cut : cuts.cut) {
    if (cut.empty()) continue;
    ++covered;
    low = std::min(low, cut.front().from), high = std::max(high, cut.back().to);
  }
  SlopingPlane ramp;
  ramp.plane = piece.id;
  ramp.slope_deg = piece.tilt_deg();
  ramp.uphill = {uphill.x(), uphill.y(), 0};
  ramp.width_m = covered * kCutM;
  ramp.run_m = high - low;
  ramp.rise_m = ramp.run_m * std::tan(ramp.slope_deg / kDegrees);
  if (covered == 0 || ramp.width_m < options.width_min_m || ramp.rise_m < options.rise_min_m)
    return {};
  const double across = heading.across().dot(piece.centroid.head<2>());
  ramp.lower =
      level_at_end(cuts, heading, piece.z_at(heading.place(low, across)), false, levels, options);
  ramp.upper =
      level_at_end(cuts, heading, piece.z_at(heading.place(high, across)), true, levels, options);
  if (ramp.lower.empty() && ramp.upper.empty()) return {};
  return ramp;
}

}  // namespace planescope::planes
