// Polygon operations using GEOS, and a convex decomposition.

#include "core/planes/outline/polygons.hpp"

#include <geos_c.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"

namespace planescope::planes {
namespace {

/// One per call: a GEOS handle must not be shared between threads.
class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) {
    GEOSContext_setErrorMessageHandler_r(
        handle_, [](const char* text, void* to) { *static_cast<std::string*>(to) = text; },
        &message_);
  }
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  struct Free {
    GEOSContextHandle_t handle = nullptr;
    void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(handle, geometry); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Free>;

  /// Throws Error if GEOS returns nothing.
  template <typename Make, typename... Args>
  Geometry make(const Make& function, Args... args) const {
    GEOSGeometry* made = function(handle_, args...);
    if (!made) fail();
    return {made, Free{handle_}};
  }

  Geometry of(const Polygons& polygons) const {
    std::vector<Geometry> parts;
    for (const Polygon& polygon : polygons) parts.push_back(of(polygon));
    std::vector<GEOSGeometry*> given = handed_over(parts);
    return make(GEOSGeom_createCollection_r, static_cast<int>(GEOS_MULTIPOLYGON), given.data(),
                static_cast<unsigned>(given.size()));
  }
  Geometry of(const Polygon& polygon) const {
    Geometry outer = of(polygon.outer);
    std::vector<Geometry> holes;
    for (const PolygonRing& hole : polygon.holes) holes.push_back(of(hole));
    std::vector<GEOSGeometry*> given = handed_over(holes);
    return make(GEOSGeom_createPolygon_r, outer.release(), given.data(),
                static_cast<unsigned>(given.size()));
  }

  /// Collects all polygons of a geometry; parts without area are dropped.
  Polygons polygons_of(const GEOSGeometry* geometry) const {
    Polygons all;
    add_polygons(geometry, all);
    return all;
  }

  bool is_valid(const GEOSGeometry* geometry) const {
    const char valid = GEOSisValid_r(handle_, geometry);  // 2: GEOS failed
    if (valid == 2) fail();
    return valid == 1;
  }

  /// Corners of a line.
  std::vector<Vec2d> points_of(const GEOSGeometry* line) const {
    const GEOSCoordSequence* points = GEOSGeom_getCoordSeq_r(handle_, line);
    unsigned count = 0;
    GEOSCoordSeq_getSize_r(handle_, points, &count);
    std::vector<double> xy(2 * count);
    GEOSCoordSeq_copyToBuffer_r(handle_, points, xy.data(), false, false);
    std::vector<Vec2d> all;
    for (unsigned i = 0; i < count; ++i) all.emplace_back(xy[2 * i], xy[2 * i + 1]);
    return all;
  }

 private:
  /// GEOS reports exceptions by their text only; rethrow out-of-memory as bad_alloc.
  [[noreturn]] void fail() const {
    if (message_ == std::bad_alloc().what()) throw std::bad_alloc();
    throw Error("polygons: " + message_);
  }

  /// Passes ownership to a GEOS function that frees its arguments even on failure; must be the last
  /// step before the call.
  static std::vector<GEOSGeometry*> handed_over(std::vector<Geometry>& parts) {
    std::vector<GEOSGeometry*> given(parts.size());
    std::ranges::transform(parts, given.begin(), &Geometry::release);
    return given;
  }

  Geometry of(const PolygonRing& ring) const {
    if (ring.size() < 3) throw Error("polygons: a ring has fewer than three corners");
    std::vector<double> xy;
    xy.reserve(2 * ring.size() + 2);
    for (const Vec2d& p : ring) xy.insert(xy.end(), {p.x(), p.y()});
    xy.insert(xy.end(), {ring[0].x(), ring[0].y()});
    GEOSCoordSequence* points = GEOSCoordSeq_copyFromBuffer_r(
        handle_, xy.data(), static_cast<unsigned>(ring.size() + 1), false, false);
    if (!points) fail();
    return make(GEOSGeom_createLinearRing_r, points);
  }

  void add_polygons(const GEOSGeometry* geometry, Polygons& all) const {
    const int type = GEOSGeomTypeId_r(handle_, geometry);
    if (type == GEOS_POLYGON) {
      if (GEOSisEmpty_r(handle_, geometry) == 1) return;
      Polygon& polygon = all.emplace_back();
      polygon.outer = ring_of(GEOSGetExteriorRing_r(handle_, geometry), true);
      for (int h = 0; h < GEOSGetNumInteriorRings_r(handle_, geometry); ++h)
        polygon.holes.push_back(ring_of(GEOSGetInteriorRingN_r(handle_, geometry, h), false));
    } else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
      for (int k = 0; k < GEOSGetNumGeometries_r(handle_, geometry); ++k)
        add_polygons(GEOSGetGeometryN_r(handle_, geometry, k), all);
    }
  }

  PolygonRing ring_of(const GEOSGeometry* line, bool counter_clockwise) const {
    PolygonRing ring = points_of(line);
    if (!ring.empty()) ring.pop_back();  // repeats the first point
    if ((polygon_area(ring) > 0) != counter_clockwise) std::ranges::reverse(ring);
    return ring;
  }

  GEOSContextHandle_t handle_;
  mutable std::string message_;
};

template <typename Operation>
Polygons combined(const Polygons& a, const Polygons& b, const Operation& operation) {
  const Geos geos;
  const Geos::Geometry first = geos.of(a), second = geos.of(b);
  // Snap to a grid of 1 nm: without it, GEOS 3.11 can fail on borders that nearly coincide.
  constexpr double kGrid_m = 1e-9;
  return geos.polygons_of(geos.make(operation, first.get(), second.get(), kGrid_m).get());
}

std::vector<Triangle> triangles_of(const Polygons& polygons) {
  const Geos geos;
  const Geos::Geometry given = geos.of(polygons);
  std::vector<Triangle> triangles;
  for (const Polygon& part :
       geos.polygons_of(geos.make(GEOSConstrainedDelaunayTriangulation_r, given.get()).get()))
    if (part.outer.size() == 3) triangles.push_back({part.outer[0], part.outer[1], part.outer[2]});
  return triangles;
}

/// GEOS 3.11 opens holes by cuts toward corners of other rings, and finds no triangulation if a cut
/// passes through a third corner. Many aligned corners (such as those of grid cells) cause this;
/// rotating them avoids it.
std::vector<Triangle> triangles_when_turned(const Polygons& polygons) {
  const Eigen::Rotation2Dd turn(0.7);
  std::map<std::pair<double, double>, Vec2d> corner_at;
  const auto turned = [&](const PolygonRing& ring) {
    PolygonRing other;
    for (const Vec2d& p : ring) {
      other.emplace_back(turn * p);
      corner_at[{other.back().x(), other.back().y()}] = p;
    }
    return other;
  };
  Polygons all;
  for (const Polygon& polygon : polygons) {
    Polygon& other = all.emplace_back(Polygon{turned(polygon.outer), {}});
    for (const PolygonRing& hole : polygon.holes) other.holes.push_back(turned(hole));
  }
  std::vector<Triangle> triangles = triangles_of(all);
  for (Triangle& triangle : triangles)
    for (Vec2d& p : triangle) p = corner_at.at({p.x(), p.y()});
  return triangles;
}

}  // namespace

double area(const Polygon& polygon) {
  double sum = polygon_area(polygon.outer);
  for (const PolygonRing& hole : polygon.holes) sum += polygon_area(hole);
  return sum;
}

double area(std::span<const Polygon> polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area(polygon);
  return sum;
}

Polygons simplified(const Polygons& polygons, double tolerance_m) {
  const Geos geos;
  const Geos::Geometry given = geos.of(polygons);
  return geos.polygons_of(
      geos.make(GEOSTopologyPreserveSimplify_r, given.get(), tolerance_m).get());
}

Polygons repaired(const Polygon& polygon) {
  const Geos geos;
  const Geos::Geometry given = geos.of(polygon);
  return geos.polygons_of(geos.make(GEOSMakeValid_r, given.get()).get());
}

Polygons united(const Polygons& a, const Polygons& b) { return combined(a, b, GEOSUnionPrec_r); }
Polygons common(const Polygons& a, const Polygons& b) {
  return combined(a, b, GEOSIntersectionPrec_r);
}
Polygons without(const Polygons& a, const Polygons& b) {
  return combined(a, b, GEOSDifferencePrec_r);
}

Polygons inset(const Polygons& polygons, double distance_m) {
  // Mitered: each corner of an obstacle becomes one corner, slightly farther away than requested.
  // Round corners would be chains of short edges, each a reflex corner that ends a convex piece.
  constexpr int kQuadrantSegments = 8;  // for corners beyond the miter limit
  constexpr double kMitreLimit = 1.5;   // [distance]
  const Geos geos;
  const Geos::Geometry given = geos.of(polygons);
  return geos.polygons_of(geos.make(GEOSBufferWithStyle_r, given.get(), -distance_m,
                                    kQuadrantSegments, static_cast<int>(GEOSBUF_CAP_ROUND),
                                    static_cast<int>(GEOSBUF_JOIN_MITRE), kMitreLimit)
                              .get());
}

std::vector<Triangle> triangulated(const Polygons& polygons) {
  try {
    return triangles_of(polygons);
  } catch (const Error&) {
    return triangles_when_turned(polygons);
  }
}

Circle largest_circle(const Polygons& polygons, double tolerance_m) {
  if (!(area(polygons) > 0)) return {};
  const Geos geos;
  const Geos::Geometry given = geos.of(polygons);
  const std::vector<Vec2d> radius =
      geos.points_of(geos.make(GEOSMaximumInscribedCircle_r, given.get(), tolerance_m).get());
  return {radius.front(), (radius.back() - radius.front()).norm()};
}

bool is_in(const PolygonRing& ring, const Vec2d& p) {
  bool in = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      in = !in;
  }
  return in;
}

bool is_valid(const Polygons& polygons) {
  const Geos geos;
  return geos.is_valid(geos.of(polygons).get());
}

// ---- Convex pieces ----

namespace {

constexpr double kTouch_m = 1e-7;  // points closer than this coincide

double cross(const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The left side of a line.
struct HalfPlane {
  Vec2d from, along;
  double inside(const Vec2d& p) const { return cross(along, p - from); }
};

PolygonRing cut(const PolygonRing& convex, const HalfPlane& half) {
  PolygonRing kept;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vec2d &a = convex[i], &b = convex[(i + 1) % convex.size()];
    const double at_a = half.inside(a), at_b = half.inside(b);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0))
      kept.push_back(a + (b - a) * (at_a / (at_a - at_b)));
  }
  return kept;
}

struct Piece {
  PolygonRing ring;
  double area_m2 = 0;
  std::set<int> neighbors;
  bool gone = false;
};

/// Two pieces merged into one convex piece.
struct Join {
  int a = 0, b = 0;
  PolygonRing ring;
  double area_m2 = 0, loss_m2 = 0, shared_m = 0;
};

/// The overlap of edge a of one piece and edge b of another.
struct Shared {
  std::size_t a = 0, b = 0;
  Vec2d begin, end;  // in the direction of the first piece
  double length_m = 0;
};

std::optional<Shared> shared_edge(const PolygonRing& a, const PolygonRing& b) {
  std::optional<Shared> longest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2d& a0 = a[i];
    const Vec2d along = a[(i + 1) % a.size()] - a0;
    const double length = along.norm();
    if (length < kTouch_m) continue;
    const Vec2d unit = along / length;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec2d to_begin = b[(j + 1) % b.size()] - a0, to_end = b[j] - a0;
      if (std::abs(cross(unit, to_begin)) > kTouch_m || std::abs(cross(unit, to_end)) > kTouch_m)
        continue;
      const double begin = std::max(0.0, unit.dot(to_begin));
      const double end = std::min(length, unit.dot(to_end));
      if (end - begin > std::max(kTouch_m, longest ? longest->length_m : 0))
        longest = Shared{i, j, a0 + begin * unit, a0 + end * unit, end - begin};
    }
  }
  return longest;
}

/// Lines that can cut the corner at `at` to make it convex, where the boundary of two joined pieces
/// passes from edge `i` of `from` to the end of edge `j` of `to`. Empty if it is already convex.
std::vector<HalfPlane> cuts_at(
    const Vec2d& at, const PolygonRing& from, std::size_t i, const PolygonRing& to, std::size_t j) {
  const auto corner = [](const PolygonRing& ring, std::size_t k) { return ring[k % ring.size()]; };
  const bool whole_from = (corner(from, i) - at).norm() < kTouch_m;
  const Vec2d before = whole_from ? corner(from, i + from.size() - 1) : corner(from, i);
  const bool whole_to = (corner(to, j + 1) - at).norm() < kTouch_m;
  const Vec2d after = whole_to ? corner(to, j + 2) : corner(to, j + 1);
  const Vec2d in = at - before, out = after - at;
  if (cross(in, out) >= 0) return {};
  return {{at, in}, {at, out}};
}

/// The largest convex piece of both that is bounded by lines through their common corners.
std::optional<Join> join_of(const std::vector<Piece>& pieces, int a, int b) {
  const PolygonRing &first = pieces[a].ring, &second = pieces[b].ring;
  const std::optional<Shared> shared = shared_edge(first, second);
  if (!shared) return std::nullopt;
  std::vector<HalfPlane> begins = cuts_at(shared->begin, first, shared->a, second, shared->b);
  std::vector<HalfPlane> ends = cuts_at(shared->end, second, shared->b, first, shared->a);
  const HalfPlane everything{Vec2d::Zero(), Vec2d::Zero()};
  if (begins.empty()) begins = {everything};
  if (ends.empty()) ends = {everything};
  const double both_m2 = pieces[a].area_m2 + pieces[b].area_m2;
  std::optional<Join> best;
  for (const HalfPlane& begin : begins)
    for (const HalfPlane& end : ends) {
      const PolygonRing of_a = cut(cut(first, begin), end), of_b = cut(cut(second, begin), end);
      std::vector<Vec2d> corners = of_a;
      corners.insert(corners.end(), of_b.begin(), of_b.end());
      Join join{a, b, convex_hull(std::move(corners)), 0, 0, shared->length_m};
      join.area_m2 = polygon_area(join.ring);
      const double kept_m2 = polygon_area(of_a) + polygon_area(of_b);
      if (join.ring.size() < 3 || join.area_m2 > kept_m2 + 1e-9 * both_m2) continue;  // not convex
      join.loss_m2 = std::max(0.0, both_m2 - join.area_m2);
      if (join.loss_m2 < 1e-9 * both_m2) join.loss_m2 = 0;
      if (!best || join.loss_m2 < best->loss_m2) best = std::move(join);
    }
  return best;
}

std::vector<Piece> pieces_of(const std::vector<Triangle>& triangles) {
  using Edge = std::array<double, 4>;
  std::map<Edge, int> by_edge;
  std::vector<Piece> pieces;
  for (const Triangle& triangle : triangles) {
    Piece piece{{triangle.begin(), triangle.end()}, 0, {}, false};
    piece.area_m2 = polygon_area(piece.ring);
    const int number = static_cast<int>(pieces.size());
    for (int i = 0; i < 3; ++i) {
      const Vec2d &a = triangle[i], &b = triangle[(i + 1) % 3];
      if (const auto other = by_edge.find({b.x(), b.y(), a.x(), a.y()}); other != by_edge.end()) {
        piece.neighbors.insert(other->second);
        pieces[other->second].neighbors.insert(number);
      }
      by_edge[{a.x(), a.y(), b.x(), b.y()}] = number;
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

class Joining {
 public:
  explicit Joining(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
    for (int a = 0; a < static_cast<int>(pieces_.size()); ++a)
      for (const int b : pieces_[a].neighbors)
        if (a < b) consider(a, b);
  }

  /// Joins pieces while the total area lost is at most `budget_m2`.
  std::vector<PolygonRing> spend(double budget_m2) {
    while (true) {
      const auto join = std::ranges::min_element(joins_, [](const Join& a, const Join& b) {
        return a.loss_m2 != b.loss_m2 ? a.loss_m2 < b.loss_m2 : a.shared_m > b.shared_m;
      });
      const int sliver = smallest();
      const bool can_join = join != joins_.end();
      const bool drop = sliver >= 0 && (!can_join || pieces_[sliver].area_m2 < join->loss_m2);
      if (!drop && !can_join) break;
      const double cost_m2 = drop ? pieces_[sliver].area_m2 : join->loss_m2;
      if (cost_m2 > budget_m2) break;
      budget_m2 -= cost_m2;
      if (drop)
        remove(sliver);
      else
        make(Join(*join));
    }
    std::vector<PolygonRing> rings;
    for (Piece& piece : pieces_)
      if (!piece.gone) rings.push_back(std::move(piece.ring));
    std::ranges::stable_sort(rings, std::ranges::greater{},
                             [](const PolygonRing& ring) { return polygon_area(ring); });
    return rings;
  }

 private:
  void consider(int a, int b) {
    if (std::optional<Join> join = join_of(pieces_, a, b)) joins_.push_back(std::move(*join));
  }
  void remove(int piece) {
    pieces_[piece].gone = true;
    for (const int other : pieces_[piece].neighbors) pieces_[other].neighbors.erase(piece);
    std::erase_if(joins_, [&](const Join& join) { return join.a == piece || join.b == piece; });
  }
  void make(const Join& join) {
    Piece made{join.ring, join.area_m2, pieces_[join.a].neighbors, false};
    made.neighbors.insert(pieces_[join.b].neighbors.begin(), pieces_[join.b].neighbors.end());
    made.neighbors.erase(join.a);
    made.neighbors.erase(join.b);
    remove(join.a);
    remove(join.b);
    const int number = static_cast<int>(pieces_.size());
    pieces_.push_back(std::move(made));
    for (const int other : pieces_[number].neighbors) {
      pieces_[other].neighbors.insert(number);
      consider(other, number);
    }
  }
  int smallest() const {
    int found = -1;
    for (int i = 0; i < static_cast<int>(pieces_.size()); ++i)
      if (!pieces_[i].gone && (found < 0 || pieces_[i].area_m2 < pieces_[found].area_m2)) found = i;
    return found;
  }

  std::vector<Piece> pieces_;
  std::vector<Join> joins_;
};

}  // namespace

std::vector<PolygonRing> convex_pieces(const Polygons& polygons, double least_share) {
  if (polygons.empty()) return {};
  Joining joining(pieces_of(triangulated(polygons)));
  return joining.spend((1 - least_share) * area(polygons));
}

}  // namespace planescope::planes
