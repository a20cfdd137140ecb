#include "core/report/data/ros_json.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/model/json_fields.hpp"

namespace planescope::report {
namespace {

using RosJson = nlohmann::ordered_json;  // a message

constexpr double kRadians = std::numbers::pi / 180;  // per degree

/// geometry_msgs/Vector3, Point and Point32.
RosJson ros_vector(const Vec3d& p) {
  return {{"x", rounded(p.x())}, {"y", rounded(p.y())}, {"z", rounded(p.z())}};
}

RosJson ros_transform(const Pose& pose) {
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0) q.coeffs() *= -1;
  RosJson rotation = ros_vector(q.vec());
  rotation["w"] = rounded(q.w());
  return {{"translation", ros_vector(pose.translation())}, {"rotation", rotation}};
}

RosJson ros_polygon(const planes::Outline& outline, const planes::PolygonRing& ring) {
  RosJson points = RosJson::array();
  for (const Vec2d& corner : ring) points.push_back(ros_vector(outline.world(corner)));
  return {{"points", points}};
}

RosJson ros_polygons(const planes::Outline& outline,
                     const std::vector<planes::PolygonRing>& rings) {
  RosJson polygons = RosJson::array();
  for (const planes::PolygonRing& ring : rings) polygons.push_back(ros_polygon(outline, ring));
  return polygons;
}

/// Minor planes are in no message.
RosJson ros_ids(const planes::LevelPlanes& planes) {
  RosJson ids = RosJson::array();
  for (const int id : planes)
    if (id > 0) ids.push_back(id);
  return ids;
}

RosJson ros_plane(const planes::FramePlanes& found, std::size_t k) {
  const planes::PlaneSummary& summary = found.summaries[k];
  const planes::Outline& outline = found.outlines[k];
  const planes::Foothold& foothold = found.footholds[k];
  RosJson parts = RosJson::array();
  for (const planes::Outline::Part& part : outline.parts)
    parts.push_back({{"outer", ros_polygon(outline, part.outer)},
                     {"holes", ros_polygons(outline, part.holes)},
                     {"unknown", ros_polygons(outline, part.unknown)}});
  const double height = found.stairs.height_m[k];
  const bool has_margin = std::isfinite(summary.margin);
  const bool has_height = !std::isnan(height);
  RosJson places = RosJson::array();
  if (foothold.space) places = ros_polygons(outline, foothold.space->pieces);
  return {{"id", summary.id},
          {"label", static_cast<int>(summary.label)},
          {"normal", ros_vector(summary.normal)},
          {"offset", rounded(summary.offset_m)},
          {"centroid", ros_vector(summary.centroid)},
          {"sigma_tilt",
           {rounded(foothold.certainty.sigma_tilt_rad[0]),
            rounded(foothold.certainty.sigma_tilt_rad[1])}},
          {"sigma_offset", rounded(foothold.certainty.sigma_offset_m)},
          {"points", summary.points},
          {"rms", rounded(summary.rms_m)},
          {"undecided", summary.undecided},
          {"has_margin", has_margin},
          {"margin", has_margin ? rounded(summary.margin) : 0.0},
          {"outline", parts},
          {"area", rounded(outline.area_m2)},
          {"has_height", has_height},
          {"height", has_height ? rounded(height) : 0.0},
          {"steppable", foothold.steppable},
          {"why_not", foothold.why_not},
          {"places", places}};
}

RosJson ros_step(const planes::LevelPlanes& lower,
                 const planes::LevelPlanes& upper,
                 int riser,
                 double rise_m,
                 double going_m,
                 const planes::NosingLine& nosing) {
  return {{"lower", ros_ids(lower)},
          {"upper", ros_ids(upper)},
          {"riser", std::max(0, riser)},
          {"rise", rounded(rise_m)},
          {"going", rounded(going_m)},
          {"nosing_right", ros_vector(nosing.right)},
          {"nosing_left", ros_vector(nosing.left)}};
}

RosJson ros_flight(const planes::Flight& flight) {
  RosJson steps = RosJson::array();
  const planes::LevelPlanes* below = &flight.foot;
  for (const planes::Flight::Step& step : flight.steps) {
    steps.push_back(
        ros_step(*below, step.tread, step.riser, step.rise_m, step.going_m, step.nosing));
    below = &step.tread;
  }
  return {{"steps", steps},
          {"rise", rounded(flight.rise_m)},
          {"going", rounded(flight.going_m)},
          {"width", rounded(flight.width_m)},
          {"uphill", ros_vector(flight.uphill)},
          {"landing", flight.landing}};
}

RosJson ros_ramp(const planes::SlopingPlane& ramp) {
  return {{"plane", std::max(0, ramp.plane)}, {"slope", rounded(ramp.slope_deg * kRadians)},
          {"rise", rounded(ramp.rise_m)},     {"run", rounded(ramp.run_m)},
          {"width", rounded(ramp.width_m)},   {"uphill", ros_vector(ramp.uphill)},
          {"lower", ros_ids(ramp.lower)},     {"upper", ros_ids(ramp.upper)}};
}

/// builtin_interfaces/Time
RosJson ros_time(double timestamp_s) {
  const double whole = std::floor(std::max(0.0, timestamp_s));
  const double rest = std::max(0.0, timestamp_s) - whole;
  return {{"sec", static_cast<std::int64_t>(whole)},
          {"nanosec", std::min<std::int64_t>(999'999'999, std::llround(rest * 1e9))}};
}

}  // namespace

std::string ros_json(const Frame& frame,
                     const planes::FrameResult& result,
                     const planes::FramePlanes& found) {
  RosJson planes = RosJson::array(), flights = RosJson::array();
  RosJson kerbs = RosJson::array(), ramps = RosJson::array();
  for (std::size_t k = 0; k < found.summaries.size(); ++k) planes.push_back(ros_plane(found, k));
  for (const planes::Flight& flight : found.stairs.flights) flights.push_back(ros_flight(flight));
  for (const planes::Kerb& kerb : found.stairs.kerbs)
    kerbs.push_back(ros_step(kerb.lower, kerb.upper, kerb.riser, kerb.rise_m, 0, kerb.nosing));
  for (const planes::SlopingPlane& ramp : found.stairs.ramps) ramps.push_back(ros_ramp(ramp));
  return RosJson({{"header",
                   {{"stamp", ros_time(frame.timestamp_s)}, {"frame_id", "planescope_world"}}},
                  {"sensor", ros_transform(result.cloud.T_world_sensor)},
                  {"gravity_known", result.gravity.known()},
                  {"planes", planes},
                  {"flights", flights},
                  {"kerbs", kerbs},
                  {"ramps", ramps}})
      .dump();
}

}  // namespace planescope::report
