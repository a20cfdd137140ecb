// Outlines from region borders in the image, or from occupied grid cells at grazing angles.

#include "core/planes/outline/outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "core/planes/cloud/camera.hpp"
#include "core/planes/outline/rings.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {
namespace {

/// Image of region labels, for pixels or grid cells.
struct LabelImage {
  int width = 0, height = 0;
  std::vector<std::int32_t> labels;  // plane id; 0: none

  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
};

/// Whether a pixel without the plane's label shows something else there.
using IsForeign = std::function<bool(std::size_t pixel, std::int32_t plane)>;

/// Projects a ring onto its plane; empty if that is impossible.
using OntoPlane = std::function<PolygonRing(const Ring&)>;

class Hole {
 public:
  Hole(const Ring& ring,
       const LabelImage& image,
       const IsForeign& is_foreign,
       const OutlineOptions& options)
      : runs_(pixels_inside(ring)) {
    int foreign = 0;
    for (const PixelRun& run : runs_)
      for (int x = run.x0; x < run.x1; ++x) {
        const std::size_t i = image.at(x, run.y);
        if (image.labels[i] == ring.label) continue;
        if (image.labels[i] > 0)
          has_others_ = true, ++foreign;
        else if (is_foreign(i, ring.label))
          ++foreign;
        if (foreign < options.least_seen_px) continue;
        was_seen_ = true;
        return;
      }
  }
  bool was_seen() const { return was_seen_; }
  /// Whether an unseen hole contains other planes, which keep their pixels.
  bool has_others() const { return has_others_; }
  void fill(std::int32_t plane, LabelImage& image) const {
    for (const PixelRun& run : runs_)
      for (int x = run.x0; x < run.x1; ++x) image.labels[image.at(x, run.y)] = plane;
  }

 private:
  std::vector<PixelRun> runs_;
  bool was_seen_ = false, has_others_ = false;
};

/// Assigns small holes in which nothing else was seen to the surrounding plane, and returns the
/// rings of the resulting image.
std::vector<Ring> close_gaps(LabelImage& image,
                             const IsForeign& is_foreign,
                             const OntoPlane& onto_plane,
                             const OutlineOptions& options) {
  std::vector<Ring> rings = trace_rings(image.labels, image.width, image.height);
  bool closed = false;
  for (const Ring& ring : rings) {
    if (!ring.hole) continue;
    const Hole hole(ring, image, is_foreign, options);
    if (hole.was_seen() || hole.has_others()) continue;
    const PolygonRing on_plane = onto_plane(ring);
    if (on_plane.empty() || std::abs(polygon_area(on_plane)) > options.gap_m * options.gap_m)
      continue;
    hole.fill(ring.label, image);
    closed = true;
  }
  return closed ? trace_rings(image.labels, image.width, image.height) : rings;
}

struct Before {
  bool operator()(const Vec2d& a, const Vec2d& b) const {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  }
};
using Corners = std::set<Vec2d, Before>;

/// Simplifies polygons. If a hole leaves its polygon or two polygons overlap as a result,
/// simplifies more carefully and unites overlapping polygons.
Polygons simplified_soundly(const Polygons& exact, double tolerance_m) {
  Polygons simple = simplified(exact, tolerance_m);
  if (is_valid(simple)) return simple;
  const auto with_care = [&](const Polygon& polygon) {
    for (const double finer_m : {tolerance_m, tolerance_m / 2, tolerance_m / 4})
      if (Polygons found = simplified({polygon}, finer_m); is_valid(found)) return found;
    return repaired(polygon);
  };
  Polygons all;
  for (const Polygon& polygon : exact) all = united(all, with_care(polygon));
  return all;
}

/// `rings`: of one plane; `on_plane`: the same rings projected onto it.
void add_parts(std::span<const Ring> rings,
               std::span<PolygonRing> on_plane,
               const LabelImage& image,
               const IsForeign& is_foreign,
               const OutlineOptions& options,
               Outline& outline) {
  const double least_hole_m2 = options.tolerance_m * options.tolerance_m;
  std::map<std::int32_t, Polygon> parts;  // by part number; the outer ring comes first
  Corners unknown;                        // corners of unmeasured holes
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const double area_m2 = std::abs(polygon_area(on_plane[r]));
    if (area_m2 < (rings[r].hole ? least_hole_m2 : options.least_m2)) continue;
    if (!rings[r].hole) {
      parts[rings[r].part].outer = std::move(on_plane[r]);
    } else if (const auto part = parts.find(rings[r].part); part != parts.end()) {
      if (!Hole(rings[r], image, is_foreign, options).was_seen())
        unknown.insert(on_plane[r].begin(), on_plane[r].end());
      part->second.holes.push_back(std::move(on_plane[r]));
    }
  }
  Polygons exact;
  for (auto& [number, polygon] : parts) exact.push_back(std::move(polygon));
  for (Polygon& polygon : simplified_soundly(exact, options.tolerance_m)) {
    if (area(polygon) < options.least_m2) continue;
    outline.area_m2 += area(polygon);
    Outline::Part& part = outline.parts.emplace_back();
    part.outer = std::move(polygon.outer);
    for (PolygonRing& hole : polygon.holes) {
      // Simplifying removes corners but never adds any.
      const bool is_unknown =
          std::ranges::any_of(hole, [&](const Vec2d& p) { return unknown.contains(p); });
      (is_unknown ? part.unknown : part.holes).push_back(std::move(hole));
    }
  }
}

// ---- Pixels of a depth image ----

/// Smallest and largest depth of a plane's pixels [m].
struct Depths {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0;
};

/// Corners of a ring, with intermediate points if lens distortion bends straight lines.
std::vector<Vec2d> places(const Ring& ring, bool bent) {
  constexpr double kStep_px = 8;
  std::vector<Vec2d> all;
  all.reserve(ring.corners.size());
  for (std::size_t i = 0; i < ring.corners.size(); ++i) {
    const Vec2d from = ring.corners[i].place();
    const Vec2d to = ring.corners[(i + 1) % ring.corners.size()].place();
    const int steps = bent ? 1 + static_cast<int>((to - from).norm() / kStep_px) : 1;
    for (int s = 0; s < steps; ++s) all.push_back(from + (to - from) * s / steps);
  }
  return all;
}

/// Projects a ring along its pixels' rays onto the outline's plane. Empty if the rays do not meet
/// the plane near the pixels.
PolygonRing on_plane_along_rays(const Ring& ring,
                                const Intrinsics& camera,
                                const Pose& T_world_sensor,
                                const Outline& outline,
                                const Depths& depths) {
  constexpr double kSlack = 1.25;
  const Vec3d normal = outline.basis.u.cross(outline.basis.v);
  const Vec3d sensor = T_world_sensor.translation();
  const double height = normal.dot(outline.origin - sensor);
  PolygonRing on_plane;
  for (const Vec2d& place : places(ring, camera.distortion != Distortion::none)) {
    const Vec2d ray = pixel_to_ray(camera, place.x() - 0.5, place.y() - 0.5);
    const Vec3d along = T_world_sensor.linear() * Vec3d(ray.x(), ray.y(), 1);
    const double z = height / normal.dot(along);
    if (!(z >= depths.least / kSlack && z <= depths.greatest * kSlack)) return {};
    const Vec3d at = sensor + z * along - outline.origin;
    on_plane.emplace_back(outline.basis.u.dot(at), outline.basis.v.dot(at));
  }
  return on_plane;
}

// ---- Cells of a grid on the plane ----

/// A grid around points on a plane, with an empty margin.
class CellImage {
 public:
  /// `box`: bounds of the points.
  CellImage(std::span<const Vec2d> points,
            const Eigen::AlignedBox2d& box,
            double cell_m,
            int margin)
      : cell_m_(cell_m), low_(box.min() - Vec2d::Constant(margin * cell_m)) {
    image_.width = static_cast<int>((box.max().x() - low_.x()) / cell_m) + 1 + margin;
    image_.height = static_cast<int>((box.max().y() - low_.y()) / cell_m) + 1 + margin;
    image_.labels.assign(static_cast<std::size_t>(image_.width) * image_.height, 0);
    for (const Vec2d& p : points) {
      const Vec2d at = (p - low_) / cell_m;
      std::int32_t& cell =
          image_.labels[image_.at(static_cast<int>(at.x()), static_cast<int>(at.y()))];
      marked_ += cell == 0;
      cell = 1;
    }
  }
  int marked() const { return marked_; }
  LabelImage& image() { return image_; }
  PolygonRing on_plane(const Ring& ring) const {
    PolygonRing on_plane;
    for (const Corner& corner : ring.corners)
      on_plane.emplace_back(low_ + cell_m_ * corner.place());
    return on_plane;
  }

  /// Closes gaps of up to 2 * radius cells; the margin must be as wide.
  void close(int radius) {
    for (int round = 0; round < radius; ++round) spread(1);
    for (int round = 0; round < radius; ++round) spread(0);
  }

 private:
  void spread(std::int32_t value) {  // to the eight surrounding cells
    const std::vector<std::int32_t> before = image_.labels;
    for (int y = 1; y + 1 < image_.height; ++y)
      for (int x = 1; x + 1 < image_.width; ++x) {
        bool near = false;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) near |= before[image_.at(x + dx, y + dy)] == value;
        if (near) image_.labels[image_.at(x, y)] = value;
      }
  }
  double cell_m_;
  Vec2d low_;
  LabelImage image_;
  int marked_ = 0;
};

/// `points`: the plane's points, in plane coordinates.
void add_cells(std::span<const Vec2d> points,
               double cell_m,
               const OutlineOptions& options,
               Outline& outline) {
  constexpr double kMostCells = 1024;  // per axis; limits memory
  constexpr double kFull = 4;          // mean points per cell at which few cells of a surface
                                       // stay empty
  constexpr int kMostRadius = 4;
  if (points.empty()) return;
  Eigen::AlignedBox2d box;
  for (const Vec2d& p : points) box.extend(p);
  cell_m = std::max(cell_m, box.sizes().maxCoeff() / kMostCells);
  // Sparsely sampled surfaces are not gaps: close until half of the cells contain enough points.
  int radius = 0;
  while (radius < kMostRadius &&
         static_cast<double>(points.size()) <
             kFull * CellImage(points, box, cell_m * (2 * radius + 1), 0).marked())
    ++radius;
  CellImage cells(points, box, cell_m, radius + 2);
  cells.close(radius);
  const OntoPlane onto_plane = [&](const Ring& ring) { return cells.on_plane(ring); };
  const IsForeign none = [](std::size_t, std::int32_t) { return false; };
  LabelImage& image = cells.image();
  const std::vector<Ring> rings = close_gaps(image, none, onto_plane, options);
  std::vector<PolygonRing> on_plane;
  for (const Ring& ring : rings) on_plane.push_back(onto_plane(ring));
  add_parts(rings, on_plane, image, none, options, outline);
}

/// Points of these planes in plane coordinates, by id - 1.
std::vector<std::vector<Vec2d>> points_on(const std::vector<Outline>& outlines,
                                          const FrameResult& result,
                                          const std::set<std::int32_t>& ids) {
  std::vector<std::vector<Vec2d>> points(outlines.size());
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    const std::int32_t id = result.plane_of[i];
    if (!ids.contains(id)) continue;
    const Outline& outline = outlines[id - 1];
    const Vec3d at = result.cloud.origin + result.cloud.points[i].cast<double>() - outline.origin;
    points[id - 1].emplace_back(outline.basis.u.dot(at), outline.basis.v.dot(at));
  }
  return points;
}

// ---- Planes of a frame ----

std::vector<Outline> empty_outlines(const FrameResult& result) {
  std::vector<Outline> outlines;
  for (const PlaneRegion& plane : result.segmentation.planes)
    outlines.push_back({.origin = result.cloud.origin + plane.fit.centroid,
                        .basis = plane_basis(plane.fit.normal),
                        .parts = {}});
  return outlines;
}

/// Fills in the outlines available from pixels.
class OfPixels {
 public:
  OfPixels(const Frame& frame, const FrameResult& result, const OutlineOptions& options)
      : frame_(frame), result_(result), options_(options) {
    const Cloud& cloud = result.cloud;
    image_.width = cloud.width, image_.height = cloud.height;
    image_.labels.assign(static_cast<std::size_t>(cloud.width) * cloud.height, 0);
    const std::vector<std::vector<PointRun>> runs = runs_of_planes(result);
    depths_.resize(runs.size() + 1);
    const Vec3d ahead = cloud.T_world_sensor.linear().col(2);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Depths depths;
      for (const PointRun& run : runs[k])
        for (std::size_t i = run.begin; i < run.end; ++i) {
          image_.labels[cloud.source[i]] = static_cast<std::int32_t>(k) + 1;
          const double z = ahead.dot(cloud.points[i].cast<double>() - result.sensor());
          depths = {std::min(depths.least, z), std::max(depths.greatest, z)};
        }
      depths_[k + 1] = depths;
    }
  }

  /// Leaves planes at grazing angles unchanged.
  void add_to(std::vector<Outline>& outlines) {
    const IsForeign is_foreign = [&](std::size_t pixel, std::int32_t id) {
      const std::vector<std::uint32_t>& pixels = result_.cloud.source;  // ascending
      const auto found = std::ranges::lower_bound(pixels, pixel);
      if (found == pixels.end() || *found != pixel) return false;
      const Vec3d p = result_.cloud.points[found - pixels.begin()].cast<double>();
      const double tau_m = result_.segmentation.noise.tau((p - result_.sensor()).norm());
      return std::abs(result_.segmentation.planes[id - 1].fit.distance_m(p)) > 2 * tau_m;
    };
    const OntoPlane onto_plane = [&](const Ring& ring) {
      return on_plane_along_rays(ring, frame_.intrinsics, result_.cloud.T_world_sensor,
                                 outlines[ring.label - 1], depths_[ring.label]);
    };
    std::vector<Ring> rings = close_gaps(image_, is_foreign, onto_plane, options_);
    std::ranges::stable_sort(rings, {}, &Ring::label);
    std::vector<PolygonRing> on_plane;
    for (auto begin = rings.begin(); begin != rings.end();) {
      const std::int32_t id = begin->label;
      const auto end =
          std::find_if(begin, rings.end(), [&](const Ring& ring) { return ring.label != id; });
      on_plane.clear();
      for (auto ring = begin; ring != end; ++ring) on_plane.push_back(onto_plane(*ring));
      if (std::ranges::any_of(on_plane, &PolygonRing::empty))
        grazed_.insert(id);
      else
        add_parts({begin, end}, on_plane, image_, is_foreign, options_, outlines[id - 1]);
      begin = end;
    }
  }
  const std::set<std::int32_t>& grazed() const { return grazed_; }

 private:
  const Frame& frame_;
  const FrameResult& result_;
  const OutlineOptions& options_;
  LabelImage image_;
  std::vector<Depths> depths_;  // by plane id
  std::set<std::int32_t> grazed_;
};

}  // namespace

Polygons polygons_of(const Outline& outline) {
  Polygons polygons;
  for (const Outline::Part& part : outline.parts) {
    Polygon& polygon = polygons.emplace_back(Polygon{part.outer, part.holes});
    polygon.holes.insert(polygon.holes.end(), part.unknown.begin(), part.unknown.end());
  }
  return polygons;
}

std::vector<Outline> outlines_of(const Frame& frame,
                                 const FrameResult& result,
                                 double cell_m,
                                 const OutlineOptions& options) {
  std::vector<Outline> outlines = empty_outlines(result);
  std::set<std::int32_t> by_cells;
  if (frame.is_cloud()) {
    for (std::size_t k = 0; k < outlines.size(); ++k)
      by_cells.insert(static_cast<std::int32_t>(k) + 1);
  } else {
    OfPixels of_pixels(frame, result, options);
    of_pixels.add_to(outlines);
    by_cells = of_pixels.grazed();
  }
  const std::vector<std::vector<Vec2d>> points = points_on(outlines, result, by_cells);
  for (const std::int32_t id : by_cells)
    add_cells(points[id - 1], cell_m, options, outlines[id - 1]);
  for (Outline& outline : outlines)
    std::ranges::stable_sort(outline.parts, std::ranges::greater{},
                             [](const Outline::Part& part) { return polygon_area(part.outer); });
  return outlines;
}

Outline moved(Outline outline, const Pose& T) {
  outline.origin = T * outline.origin;
  outline.basis.u = T.linear() * outline.basis.u;
  outline.basis.v = T.linear() * outline.basis.v;
  return outline;
}

Outline outline_of_points(const Vec3d& origin,
                          const PlaneBasis& basis,
                          std::span<const Vec2d> points,
                          double cell_m,
                          const OutlineOptions& options) {
  Outline outline{.origin = origin, .basis = basis, .parts = {}};
  add_cells(points, cell_m, options, outline);
  return outline;
}

std::vector<Outline> minor_outlines_of(const FrameResult& result,
                                       double cell_m,
                                       const OutlineOptions& options) {
  const Segmentation& segmentation = result.segmentation;
  std::vector<std::uint32_t> minor_of(result.voxels.points.size(), 0);  // 1-based
  std::vector<Outline> outlines;
  for (std::size_t k = 0; k < segmentation.minor.size(); ++k) {
    const PlaneFit& fit = segmentation.minor[k].fit;
    outlines.push_back({.origin = result.cloud.origin + fit.centroid,
                        .basis = plane_basis(fit.normal),
                        .parts = {}});
    for (const std::uint32_t voxel : segmentation.minor_points[k])
      minor_of[voxel] = static_cast<std::uint32_t>(k) + 1;
  }
  std::vector<std::vector<Vec2d>> points(outlines.size());
  for (std::size_t i = 0; i < result.cloud.points.size() && !outlines.empty(); ++i) {
    const std::uint32_t voxel = result.voxels.voxel_of[i];
    if (voxel == kNoVoxel || minor_of[voxel] == 0 || result.plane_of[i] > 0) continue;
    const Outline& outline = outlines[minor_of[voxel] - 1];
    const Vec3d at = result.cloud.origin + result.cloud.points[i].cast<double>() - outline.origin;
    points[minor_of[voxel] - 1].emplace_back(outline.basis.u.dot(at), outline.basis.v.dot(at));
  }
  for (std::size_t k = 0; k < outlines.size(); ++k)
    add_cells(points[k], cell_m, options, outlines[k]);
  return outlines;
}

}  // namespace planescope::planes
