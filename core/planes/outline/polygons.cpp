#include "core/planes/outline/polygons.hpp"

#include <geos_c.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"

namespace planescope::planes {
namespace {

/// One for each call: a handle is not for two threads.
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

  /// Throws Error where GEOS made nothing.
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

  /// Of whatever has an area.
  Polygons polygons_of(const GEOSGeometry* geometry) const {
    Polygons all;
    add_polygons(geometry, all);
    return all;
  }

  bool is_valid(const GEOSGeometry* geometry) const {
    const char valid = GEOSisValid_r(handle_, geometry);  // 2: it could not be told
    if (valid == 2) fail();
    return valid == 1;
  }

  /// The corners of a line.
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
  /// GEOS tells whatever it caught by its text alone; memory that ran out is told as everywhere.
  [[noreturn]] void fail() const {
    if (message_ == std::bad_alloc().what()) throw std::bad_alloc();
    throw Error("polygons: " + message_);
  }

  /// To a function that frees them even where it makes nothing: the last step before it is called.
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
    if (!ring.empty()) ring.pop_back();  // the first again
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
  // On a grid of a nanometre: of borders that nearly coincide, GEOS 3.11 may come out wrong
  // without.
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

/// GEOS 3.11 cuts holes open towards corners of the other rings, and finds no triangle where a cut
/// runs through a third corner: so it may where many lie in rows, as those of a grid's cells do.
/// Turned, they do not.
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
  // Mitred: one corner where an obstacle has one, a little farther from it than asked for. Round
  // ones would be chains of short edges, each a reflex corner that convex pieces end at.
  constexpr int kQuadrantSegments = 8;  // of what the limit cuts
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

}  // namespace planescope::planes
