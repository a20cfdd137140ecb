// Distances and angles between picked points and planes.

#include "core/debug/explain/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/debug/explain/explain.hpp"
#include "core/model/error.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::debug {
namespace {

Vec3d in_sensor(const Subject& subject, const Vec3d& at) {
  const planes::Cloud& cloud = subject.prepared.cloud;
  return cloud.T_world_sensor.inverse() * (cloud.origin + at);
}

double distance_m(const MeasureEnd& plane, const Vec3d& point) {
  return plane.normal->dot(point - plane.point);
}

/// At larger angles the distance between planes is undefined: use the distance of the
/// clicked point.
constexpr double kParallelDeg = 15;

/// "12 cm above P3", "P5 12 cm in front of P3", "a point on P5 12 cm above P3".
std::string text_from_plane(const MeasureEnd& plane, const MeasureEnd& other, double off_m) {
  const char* side = plane.is_level ? off_m < 0 ? "below" : "above"
                     : off_m < 0    ? "behind"
                                    : "in front of";
  std::string what = other.name.empty() ? "" : other.name + " ";
  if (other.normal && planes::plane_angle_deg(*plane.normal, *other.normal) > kParallelDeg)
    what = "a point on " + what;
  return fmt::format("{}{} {} {}", what, distance_text(std::abs(off_m)), side, plane.name);
}

}  // namespace

std::string height_text(double height_m) {
  return distance_text(std::abs(height_m)) + (height_m < 0 ? " down" : " up");
}

Vec3f in_scene(const Subject& subject, const Vec3d& at) {
  const planes::Cloud& cloud = subject.prepared.cloud;
  return (cloud.T_world_sensor * at - cloud.origin).cast<float>();
}

MeasureEnd measured_point(const Subject& subject, std::size_t source) {
  const std::uint32_t point = subject.point_of_source[source];
  if (point == planes::kNoVoxel) throw Error("no measurement at this point");
  return {.point = in_sensor(subject, subject.prepared.cloud.points[point].cast<double>())};
}

MeasureEnd measured_voxel(const Subject& subject, std::uint32_t voxel) {
  return {.point = in_sensor(subject, subject.prepared.voxels.points[voxel].cast<double>())};
}

MeasureEnd measured_plane(const Run& run,
                          std::int32_t plane,
                          std::int32_t step,
                          const MeasureEnd* near) {
  const planes::PlaneChange* now = plane >= 0 ? run.timeline.plane_at(plane, step) : nullptr;
  if (!now || !now->alive) throw Error("no plane at this point");
  const Subject& subject = *run.subject;
  const Vec3d normal = planes::outward_normal(now->fit, now->label, subject.prepared.sensor());
  MeasureEnd end{.point = in_sensor(subject, now->fit.centroid),
                 .normal = subject.prepared.cloud.T_world_sensor.linear().transpose() * normal,
                 .is_level = now->label == Label::h,
                 .name = plane_name(run, plane)};
  if (near) end.point = near->point - distance_m(end, near->point) * *end.normal;
  return end;
}

Measurement measure(const Subject& subject, const MeasureEnd& first, const MeasureEnd& second) {
  Measurement measured;
  Vec3d from = first.point, to = second.point;
  const bool from_plane = first.normal || second.normal;
  if (from_plane) {
    const MeasureEnd& plane = first.normal ? first : second;
    const MeasureEnd& other = first.normal ? second : first;
    to = other.point;
    measured.distance_m = distance_m(plane, to);
    from = to - measured.distance_m * *plane.normal;
    measured.text = text_from_plane(plane, other, measured.distance_m);
  } else {
    measured.distance_m = (to - from).norm();
    measured.text = distance_text(measured.distance_m) + " apart";
  }
  measured.label = distance_text(std::abs(measured.distance_m));
  measured.from = from;
  measured.to = to;
  if (subject.prepared.gravity.known()) {
    const Vec3d up = -subject.prepared.gravity.direction.normalized();
    measured.height_m = up.dot(to - from);
    measured.corner = to - *measured.height_m * up;
    const double across_m = (measured.corner - from).norm();
    measured.text +=
        fmt::format(": {}, {} across", height_text(*measured.height_m), distance_text(across_m));
  } else {
    measured.text += "; gravity is unknown, so no heights";
  }
  if (first.normal && second.normal) {
    measured.angle_deg = planes::plane_angle_deg(*first.normal, *second.normal);
    const std::string angle = fmt::format("{:.1f}°", *measured.angle_deg);
    measured.text += ", at an angle of " + angle;
    measured.label += ", " + angle;
  }
  return measured;
}

}  // namespace planescope::debug
