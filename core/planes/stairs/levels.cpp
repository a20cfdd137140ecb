// Levels (walkable planes, joined where they touch), parallel cuts through them, and ramps.

#include "core/planes/stairs/levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/model/disjoint_sets.hpp"
#include "core/model/plane.hpp"

namespace planescope::planes {
namespace {

LevelPiece piece_of(const PlaneRegion& plane, int id, const Outline& outline) {
  LevelPiece piece;
  piece.id = id;
  piece.centroid = outline.origin;
  piece.normal = plane.fit.normal.z() < 0 ? Vec3d(-plane.fit.normal) : plane.fit.normal;
  piece.area_m2 = outline.area_m2;
  const auto add = [&](const PolygonRing& ring) {
    PolygonRing& seen = piece.rings.emplace_back();
    for (const Vec2d& corner : ring) seen.push_back(outline.world(corner).head<2>());
  };
  for (const Outline::Part& part : outline.parts) {
    add(part.outer);
    for (const PolygonRing& hole : part.holes) add(hole);
  }
  return piece;
}

/// Height difference across the plane [m].
double climb_m(const LevelPiece& piece) {
  const Vec2d slope = -piece.normal.head<2>() / piece.normal.z();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const PolygonRing& ring : piece.rings)
    for (const Vec2d& corner : ring) {
      low = std::min(low, slope.dot(corner));
      high = std::max(high, slope.dot(corner));
    }
  return std::max(0.0, high - low);
}

/// Small planes are less accurate: treat a plane as level if no step fits within its height change.
bool is_level(const LevelPiece& piece, const StairsOptions& options) {
  constexpr double kMostDeg = 20;
  const double tilt_deg = piece.tilt_deg();
  return tilt_deg <= options.level_deg ||
         (tilt_deg <= kMostDeg && climb_m(piece) <= options.rise_min_m);
}

struct Nearest {
  double distance_m = std::numeric_limits<double>::infinity();
  Vec2d at = Vec2d::Zero();
};

/// Updates the shortest distance from corners of `a` to borders of `b`.
void approach(const LevelPiece& a, const LevelPiece& b, Nearest& nearest) {
  for (const PolygonRing& of_a : a.rings)
    for (const Vec2d& p : of_a)
      for (const PolygonRing& of_b : b.rings)
        for (std::size_t i = 0; i < of_b.size(); ++i) {
          const Vec2d& from = of_b[i];
          const Vec2d edge = of_b[(i + 1) % of_b.size()] - from;
          const double share =
              std::clamp(edge.dot(p - from) / std::max(edge.squaredNorm(), 1e-12), 0.0, 1.0);
          const Vec2d foot = from + share * edge;
          if (const double d = (p - foot).norm(); d < nearest.distance_m)
            nearest = {d, (p + foot) / 2};
        }
}

/// Whether two pieces belong to one level: adjacent, with equal height there.
bool is_one_level(const LevelPiece& a, const LevelPiece& b, const StairsOptions& options) {
  const double same_m = 0.6 * options.rise_min_m;
  if (std::abs(a.centroid.z() - b.centroid.z()) > 4 * same_m) return false;
  Nearest nearest;
  approach(a, b, nearest);
  approach(b, a, nearest);
  return nearest.distance_m <= options.gap_m &&
         std::abs(a.z_at(nearest.at) - b.z_at(nearest.at)) <= same_m;
}

std::vector<Level> joined(std::vector<LevelPiece> pieces, const StairsOptions& options) {
  DisjointSets sets(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = i + 1; j < pieces.size(); ++j)
      if (is_one_level(pieces[i], pieces[j], options))
        sets.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
  std::vector<Level> levels;
  std::vector<std::size_t> level_of(pieces.size(), pieces.size());  // by the root of its set
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::size_t& level = level_of[sets.root(static_cast<std::uint32_t>(i))];
    if (level == pieces.size()) {
      level = levels.size();
      levels.emplace_back();
    }
    levels[level].pieces.push_back(std::move(pieces[i]));
  }
  for (Level& level : levels) {
    std::ranges::stable_sort(level.pieces, std::ranges::greater{}, &LevelPiece::area_m2);
    for (const LevelPiece& piece : level.pieces) {
      level.area_m2 += piece.area_m2;
      level.z_m += piece.area_m2 * piece.centroid.z();
    }
    level.z_m /= level.area_m2;
  }
  return levels;
}

void close_gaps_along(std::vector<Interval>& cut, double close_m) {
  std::ranges::sort(cut, {}, &Interval::from);
  std::size_t closed = 0;
  for (const Interval next : cut) {
    if (closed > 0 && next.from - cut[closed - 1].to <= close_m)
      cut[closed - 1].to = std::max(cut[closed - 1].to, next.to);
    else
      cut[closed++] = next;
  }
  cut.resize(closed);
}

/// Intersection of an edge with a cut.
struct Crossing {
  int cut = 0;
  double at_m = 0;  // position along the heading
};

}  // namespace

double LevelPiece::tilt_deg() const { return std::acos(std::min(1.0, normal.z())) * kDegrees; }

LevelPlanes Level::ids() const {
  LevelPlanes ids;
  for (const LevelPiece& piece : pieces) ids.push_back(piece.id);
  return ids;
}

LevelPlanesOf levels_of(const CoveringPlanes& found,
                        const CoveringPlanes& minor,
                        const StairsOptions& options) {
  std::vector<LevelPiece> level;
  LevelPlanesOf sorted;
  for (std::size_t i = 0; i < found.planes.size(); ++i) {
    if (found.planes[i].label != Label::h || found.outlines[i].parts.empty()) continue;
    LevelPiece piece = piece_of(found.planes[i], found.planes[i].id, found.outlines[i]);
    (is_level(piece, options) ? level : sorted.tilted).push_back(std::move(piece));
  }
  sorted.levels = joined(std::move(level), options);
  for (std::size_t i = 0; i < minor.planes.size(); ++i) {
    if (minor.planes[i].label != Label::h || minor.outlines[i].parts.empty()) continue;
    LevelPiece piece = piece_of(minor.planes[i], -1 - static_cast<int>(i), minor.outlines[i]);
    if (!is_level(piece, options)) continue;
    const double z_m = piece.centroid.z(), area_m2 = piece.area_m2;
    sorted.levels.push_back({{std::move(piece)}, z_m, area_m2, /*minor=*/true});
  }
  std::ranges::stable_sort(sorted.levels, {}, &Level::z_m);
  return sorted;
}

std::span<const Interval> Cuts::at(int index) const {
  if (index < first || index >= end()) return {};
  return cut[static_cast<std::size_t>(index - first)];
}

Cuts cuts_of(std::span<const PolygonRing> rings, const Heading& heading, double close_m) {
  const Vec2d across = heading.across();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const PolygonRing& ring : rings)
    for (const Vec2d& corner : ring) {
      low = std::min(low, across.dot(corner));
      high = std::max(high, across.dot(corner));
    }
  Cuts cuts;
  if (!(low < high)) return cuts;
  cuts.first = static_cast<int>(std::floor(low / kCutM));
  cuts.cut.resize(static_cast<std::size_t>(std::floor(high / kCutM)) - cuts.first + 1);
  std::vector<Crossing> crossings;
  for (const PolygonRing& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
      const double ta = across.dot(a), tb = across.dot(b);
      const double sa = heading.along.dot(a), sb = heading.along.dot(b);
      // One extra on either side, to allow for rounding.
      const int first = static_cast<int>(std::floor(std::min(ta, tb) / kCutM)) - 1;
      const int last = static_cast<int>(std::floor(std::max(ta, tb) / kCutM)) + 1;
      for (int k = std::max(first, cuts.first); k <= std::min(last, cuts.end() - 1); ++k) {
        const double t = Cuts::across(k);
        if ((ta <= t) == (tb <= t)) continue;
        crossings.push_back({k, sa + (sb - sa) * (t - ta) / (tb - ta)});
      }
    }
  std::ranges::sort(crossings, {}, [](const Crossing& c) { return std::pair(c.cut, c.at_m); });
  for (std::size_t i = 0; i + 1 < crossings.size();) {
    const Crossing &from = crossings[i], &to = crossings[i + 1];
    const bool is_inside = from.cut == to.cut;
    if (is_inside)
      cuts.cut[static_cast<std::size_t>(from.cut - cuts.first)].push_back({from.at_m, to.at_m});
    i += is_inside ? 2 : 1;
  }
  for (std::vector<Interval>& cut : cuts.cut) close_gaps_along(cut, close_m);
  return cuts;
}

Cuts cuts_of(const Level& level, const Heading& heading, double close_m) {
  Cuts all;
  for (const LevelPiece& piece : level.pieces) {
    Cuts cuts = cuts_of(piece.rings, heading, 0);
    if (cuts.cut.empty()) continue;
    if (all.cut.empty()) all.first = cuts.first;
    if (cuts.first < all.first) {
      all.cut.insert(all.cut.begin(), static_cast<std::size_t>(all.first - cuts.first), {});
      all.first = cuts.first;
    }
    all.cut.resize(std::max(all.end(), cuts.end()) - all.first);
    for (int k = cuts.first; k < cuts.end(); ++k) {
      std::vector<Interval>& cut = all.cut[static_cast<std::size_t>(k - all.first)];
      cut.insert(cut.end(), cuts.at(k).begin(), cuts.at(k).end());
    }
  }
  for (std::vector<Interval>& cut : all.cut) close_gaps_along(cut, close_m);
  return all;
}

std::vector<Heading> headings_of(std::span<const Level> levels, const CoveringPlanes& found) {
  constexpr int kBins = 180, kSpread = 5, kApart = 8, kMost = 12;
  constexpr double kLeastEdgeM = 0.06;
  std::array<double, kBins> weight{};
  const auto vote = [&](const Vec2d& facing, double amount) {
    const double deg = std::atan2(facing.y(), facing.x()) * kDegrees;
    weight[static_cast<std::size_t>((std::lround(deg) + 2 * kBins) % kBins)] += amount;
  };
  for (const Level& level : levels)
    for (const LevelPiece& piece : level.pieces)
      for (const PolygonRing& ring : piece.rings)
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const Vec2d edge = ring[(i + 1) % ring.size()] - ring[i];
          if (edge.norm() >= kLeastEdgeM) vote({edge.y(), -edge.x()}, edge.norm());
        }
  for (std::size_t i = 0; i < found.planes.size(); ++i)
    if (found.planes[i].label == Label::v)
      vote(found.planes[i].fit.normal.head<2>(), std::sqrt(found.outlines[i].area_m2));

  std::array<double, kBins> smooth{};
  for (int bin = 0; bin < kBins; ++bin)
    for (int d = -kSpread; d <= kSpread; ++d)
      smooth[bin] += (kSpread + 1 - std::abs(d)) * weight[(bin + d + kBins) % kBins];
  std::vector<Heading> headings;
  while (std::ssize(headings) < 2 * kMost) {
    const auto peak = std::ranges::max_element(smooth);
    if (*peak <= 0) break;
    const int bin = static_cast<int>(peak - smooth.begin());
    const Vec2d along(std::cos(bin / kDegrees), std::sin(bin / kDegrees));
    headings.push_back({along});
    headings.push_back({-along});
    for (int d = -kApart; d <= kApart; ++d) smooth[(bin + d + kBins) % kBins] = 0;
  }
  return headings;
}

// ---- Ramps ----

namespace {

/// Level at a given height that begins or ends at the end of the ramp.
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
