// Planes as planescope_msgs/PlaneArray, markers and points.

#include "core/report/data/ros_planes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/palette.hpp"
#include "core/model/text.hpp"
#include "core/planes/cloud/camera.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;
using io::ros_header;
using io::ros_point;
using planes::Outline;
using planes::PolygonRing;

constexpr const char* kMarkerArray = "visualization_msgs/msg/MarkerArray";

template <typename Things, typename ToJson>
Json list_of(const Things& things, const ToJson& to_json) {
  Json list = Json::array();
  for (const auto& thing : things) list.push_back(to_json(thing));
  return list;
}

// ---- planescope_msgs/PlaneArray ----

Json ros_polygon(const Outline& outline, const PolygonRing& ring) {
  return {{"points", list_of(ring, [&](const Vec2d& p) { return ros_point(outline.world(p)); })}};
}

Json ros_polygons(const Outline& outline, const std::vector<PolygonRing>& rings) {
  return list_of(rings, [&](const PolygonRing& ring) { return ros_polygon(outline, ring); });
}

/// Messages do not contain minor planes.
Json ros_ids(const planes::LevelPlanes& planes) {
  Json ids = Json::array();
  for (const int id : planes)
    if (id > 0) ids.push_back(id);
  return ids;
}

int track_of(const planes::FramePlanes& found, std::size_t k) {
  return found.tracks ? (*found.tracks)[k] : 0;
}

Json ros_plane(const planes::FramePlanes& found, std::size_t k) {
  const planes::PlaneSummary& summary = found.summaries[k];
  const Outline& outline = found.outlines[k];
  const planes::Foothold& foothold = found.footholds[k];
  const Json parts = list_of(outline.parts, [&](const Outline::Part& part) -> Json {
    return {{"outer", ros_polygon(outline, part.outer)},
            {"holes", ros_polygons(outline, part.holes)},
            {"unknown", ros_polygons(outline, part.unknown)}};
  });
  const double height = found.stairs.height_m[k];
  const bool has_margin = std::isfinite(summary.margin);
  const bool has_height = !std::isnan(height);
  Json places = Json::array();
  if (foothold.space) places = ros_polygons(outline, foothold.space->pieces);
  return {{"id", summary.id},
          {"track", track_of(found, k)},
          {"label", static_cast<int>(summary.label)},
          {"normal", ros_point(summary.normal)},
          {"offset", rounded(summary.offset_m)},
          {"centroid", ros_point(summary.centroid)},
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

Json ros_step(const planes::LevelPlanes& lower,
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
          {"nosing_right", ros_point(nosing.right)},
          {"nosing_left", ros_point(nosing.left)}};
}

Json ros_flight(const planes::Flight& flight) {
  Json steps = Json::array();
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
          {"uphill", ros_point(flight.uphill)},
          {"landing", flight.landing}};
}

Json ros_ramp(const planes::SlopingPlane& ramp) {
  return {{"plane", std::max(0, ramp.plane)},
          {"slope", rounded(ramp.slope_deg * (std::numbers::pi / 180))},
          {"rise", rounded(ramp.rise_m)},
          {"run", rounded(ramp.run_m)},
          {"width", rounded(ramp.width_m)},
          {"uphill", ros_point(ramp.uphill)},
          {"lower", ros_ids(ramp.lower)},
          {"upper", ros_ids(ramp.upper)}};
}

io::RosMessage planes_message(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::FramePlanes& found,
                              const RosPlace& place) {
  return io::ros_message("planes", "planescope_msgs/msg/PlaneArray",
                         plane_array(frame, result, found, place));
}

// ---- Markers: https://docs.ros.org/en/humble/p/visualization_msgs/msg/Marker.html ----

enum MarkerType : std::uint8_t { kArrow = 0, kLines = 5, kText = 9, kTriangles = 11 };
constexpr int kDeleteAll = 3;

constexpr std::uint32_t kNosingHue = 0xFDB803, kGray = 0x8A8F98;
constexpr std::uint32_t kSteppableHue = 0x18CC90, kNotSteppableHue = 0xD55E00;

Json color_json(std::uint32_t hue, double alpha = 1) {
  const auto share = [&](int shift) { return rounded((hue >> shift & 0xFF) / 255.0); };
  return {{"r", share(16)}, {"g", share(8)}, {"b", share(0)}, {"a", alpha}};
}

/// A MarkerArray that begins by deleting all earlier markers.
class Markers {
 public:
  explicit Markers(std::int64_t stamp_ns) : stamp_ns_(stamp_ns) {}

  /// Sets the coordinate frame of the following markers.
  void begin_frame(const std::string& frame_id) {
    header_ = ros_header(stamp_ns_, frame_id);
    if (list_.empty()) list_.push_back({{"header", header_}, {"action", kDeleteAll}});
  }

  void lines(const char* ns, int id, std::vector<Vec3d> ends, std::uint32_t hue, double width_m) {
    if (!ends.empty()) add(ns, id, kLines, Vec3d(width_m, 0, 0), color_json(hue), ends);
  }
  void arrow(const char* ns, int id, const Vec3d& from, const Vec3d& to, std::uint32_t hue) {
    add(ns, id, kArrow, Vec3d(0.01, 0.025, 0.03), color_json(hue), {from, to});
  }
  void triangles(const char* ns, int id, const planes::Mesh& mesh, std::uint32_t hue) {
    std::vector<Vec3d> corners;
    for (const auto& triangle : mesh.triangles)
      for (const int corner : triangle)
        corners.push_back(mesh.vertices[static_cast<std::size_t>(corner)]);
    if (!corners.empty()) add(ns, id, kTriangles, Vec3d::Ones(), color_json(hue, 0.35), corners);
  }
  void text(const char* ns, int id, const Vec3d& at, const std::string& text) {
    Json& marker = add(ns, id, kText, Vec3d(0, 0, 0.06), color_json(0xFFFFFF), {});
    marker["pose"]["position"] = ros_point(at);
    marker["text"] = text;
  }

  void plane(const MarkedPlane& plane) {
    triangles("surface", plane.id, planes::mesh_of(*plane.outline), plane.hue);
    std::vector<Vec3d> known, unknown;
    for (const Outline::Part& part : plane.outline->parts) {
      add_edges(*plane.outline, part.outer, known);
      for (const PolygonRing& hole : part.holes) add_edges(*plane.outline, hole, known);
      for (const PolygonRing& hole : part.unknown) add_edges(*plane.outline, hole, unknown);
    }
    lines("outline", plane.id, known, plane.hue, 0.008);
    lines("unknown", plane.id, unknown, kGray, 0.004);
    arrow("normal", plane.id, plane.at, plane.at + 0.15 * plane.normal, plane.hue);
    text("name", plane.id, plane.at + 0.2 * plane.normal, plane.name);
  }

  static void add_edges(const Outline& outline, const PolygonRing& ring, std::vector<Vec3d>& to) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      to.push_back(outline.world(ring[i]));
      to.push_back(outline.world(ring[(i + 1) % ring.size()]));
    }
  }

  io::RosMessage message(const std::string& topic) {
    return io::ros_message(topic, kMarkerArray, {{"markers", std::move(list_)}});
  }

 private:
  Json& add(const char* ns,
            int id,
            MarkerType type,
            const Vec3d& scale,
            Json color,
            const std::vector<Vec3d>& points) {
    list_.push_back({{"header", header_},
                     {"ns", ns},
                     {"id", id},
                     {"type", int{type}},
                     {"pose", {{"orientation", {{"w", 1.0}}}}},
                     {"scale", ros_point(scale)},
                     {"color", std::move(color)},
                     {"points", list_of(points, ros_point)}});
    return list_.back();
  }

  std::int64_t stamp_ns_;
  Json header_, list_ = Json::array();
};

void mark_foothold(const planes::FramePlanes& found, std::size_t k, Markers& markers) {
  const planes::Foothold& foothold = found.footholds[k];
  if (!foothold.space) return;
  std::vector<Vec3d> edges;
  for (const PolygonRing& piece : foothold.space->pieces)
    Markers::add_edges(found.outlines[k], piece, edges);
  markers.lines("footholds", found.summaries[k].id, edges,
                foothold.steppable ? kSteppableHue : kNotSteppableHue, 0.005);
}

void mark_stairs(const planes::FramePlanes& found, Markers& markers) {
  const planes::Stairs& stairs = found.stairs;
  int id = 0;
  const auto mark = [&](const std::vector<Vec3d>& nosings, const std::string& text) {
    markers.lines("stairs", ++id, nosings, kNosingHue, 0.015);
    const Vec3d middle = (nosings[nosings.size() - 2] + nosings.back()) / 2;
    markers.text("stairs_text", id, middle + Vec3d(0, 0, 0.1), text);
  };
  for (const planes::Flight& flight : stairs.flights) {
    std::vector<Vec3d> nosings;
    for (const planes::Flight::Step& step : flight.steps)
      nosings.insert(nosings.end(), {step.nosing.right, step.nosing.left});
    if (nosings.empty()) continue;
    mark(nosings,
         fmt::format("{}, rise {:.0f} cm, going {:.0f} cm", counted(flight.steps.size(), "step"),
                     100 * flight.rise_m, 100 * flight.going_m));
  }
  for (const planes::Kerb& kerb : stairs.kerbs)
    mark({kerb.nosing.right, kerb.nosing.left}, fmt::format("kerb {:.0f} cm", 100 * kerb.rise_m));
  for (const planes::SlopingPlane& ramp : stairs.ramps) {
    if (ramp.plane < 1) continue;
    const Vec3d at = found.footholds[static_cast<std::size_t>(ramp.plane) - 1].surface.best_place;
    const double slope = ramp.slope_deg * (std::numbers::pi / 180);
    const Vec3d uphill = ramp.uphill * std::cos(slope) + Vec3d::UnitZ() * std::sin(slope);
    markers.arrow("ramps", ramp.plane, at, at + 0.4 * uphill, kNosingHue);
    markers.text("ramps_text", ramp.plane, at + 0.45 * uphill,
                 fmt::format("ramp {:.0f} deg", ramp.slope_deg));
  }
}

io::RosMessage markers_message(const Frame&,
                               const planes::FrameResult&,
                               const planes::FramePlanes& found,
                               const RosPlace& place) {
  Markers markers(place.stamp_ns);
  markers.begin_frame(place.world);
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const planes::PlaneSummary& plane = found.summaries[k];
    const int track = track_of(found, k);
    std::string name = plane.undecided ? "~" : "";
    name += track > 0 ? fmt::format("T{}", track) : fmt::format("P{}", plane.id);
    const std::uint32_t hue = track > 0      ? plane_hue(track)
                              : found.tracks ? kGray
                                             : plane_hue(plane.id);
    markers.plane({plane.id, hue, name, place.world, plane.normal,
                   found.footholds[k].surface.best_place, &found.outlines[k]});
    mark_foothold(found, k, markers);
  }
  mark_stairs(found, markers);
  return markers.message("markers");
}

// ---- sensor_msgs/PointCloud2 ----

enum PointFieldType : std::uint8_t { kUint32 = 6, kFloat32 = 7 };
constexpr std::uint32_t kUnseenHue = 0x808080;  // of points outside the color camera's view
constexpr double kFarthest_m = 10e3;            // floats resolve 1 mm up to there

/// Calls add(0xRRGGBB) for each point of the cloud. Returns whether there are colors.
template <typename Add>
bool for_each_color(const Frame& frame, const planes::Cloud& cloud, const Add& add) {
  const auto packed = [](const std::uint8_t* rgb) {
    return std::uint32_t{rgb[0]} << 16 | std::uint32_t{rgb[1]} << 8 | rgb[2];
  };
  if (frame.is_cloud() || frame.color_aligned) {
    const std::vector<std::uint8_t>& rgb = frame.is_cloud() ? frame.cloud->rgb : frame.color.data;
    if (rgb.empty() || (frame.color_aligned && frame.color.channels != 3)) return false;
    for (const std::uint32_t source : cloud.source) add(packed(&rgb[3 * std::size_t{source}]));
    return true;
  }
  const Intrinsics& camera = frame.color_intrinsics;
  if (frame.color.channels != 3 || !(camera.fx > 0)) return false;
  const Pose T_color_world = frame.T_color_depth * cloud.T_world_sensor.inverse();
  for (const Vec3f& point : cloud.points) {
    const Vec3d p = T_color_world * point.cast<double>();
    std::uint32_t hue = kUnseenHue;
    if (p.z() > 0) {
      const Vec2d pixel = planes::ray_to_pixel(camera, p.head<2>() / p.z());
      const double u = std::round(pixel.x()), v = std::round(pixel.y());
      if (u >= 0 && v >= 0 && u < frame.color.width && v < frame.color.height)
        hue = packed(&frame.color.at(static_cast<int>(u), static_cast<int>(v)));
    }
    add(hue);
  }
  return true;
}

io::RosMessage points_message(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::FramePlanes& found,
                              const RosPlace& place) {
  const planes::Cloud& cloud = result.cloud;
  if (cloud.origin.norm() > kFarthest_m)
    throw Error(
        fmt::format("frame {}: its points are about {:.0f} km from the origin, where floats in "
                    "sensor_msgs/PointCloud2 have errors above 1 mm; expected at most 10 km",
                    frame.index, cloud.origin.norm() / 1000));
  std::vector<std::uint32_t> colors;
  colors.reserve(cloud.points.size());
  const bool has_color =
      for_each_color(frame, cloud, [&](std::uint32_t color) { colors.push_back(color); });
  std::uint32_t step = 0;
  Json fields = Json::array();
  const auto field = [&](const char* name, PointFieldType type) {
    fields.push_back({{"name", name}, {"offset", step}, {"datatype", int{type}}, {"count", 1}});
    step += 4;
  };
  for (const char* axis : {"x", "y", "z"}) field(axis, kFloat32);
  if (has_color) field("rgb", kFloat32);  // the bits of the color, as in PCL
  field("plane", kUint32);
  if (found.tracks) field("track", kUint32);
  std::vector<std::uint32_t> words;
  words.reserve(cloud.points.size() * (step / 4));
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vec3f p = (cloud.origin + cloud.points[i].cast<double>()).cast<float>();
    for (int axis = 0; axis < 3; ++axis) words.push_back(std::bit_cast<std::uint32_t>(p[axis]));
    if (has_color) words.push_back(colors[i]);
    const std::int32_t plane = std::max(0, result.plane_of[i]);
    words.push_back(static_cast<std::uint32_t>(plane));
    if (found.tracks)
      words.push_back(plane > 0 ? static_cast<std::uint32_t>(
                                      track_of(found, static_cast<std::size_t>(plane) - 1))
                                : 0);
  }
  return io::ros_message("points", "sensor_msgs/msg/PointCloud2",
                         {{"header", ros_header(place.stamp_ns, place.world)},
                          {"height", 1},
                          {"width", cloud.points.size()},
                          {"fields", std::move(fields)},
                          {"point_step", step},
                          {"row_step", step * cloud.points.size()},
                          {"data", io::ros_bytes(words.data(), 4 * words.size())},
                          {"is_dense", true}});
}

// ---- tf2_msgs/TFMessage ----

/// The camera is the parent of the upright frame, because another program may define its parent.
io::RosMessage poses_message(const Frame& frame,
                             const planes::FrameResult& result,
                             const planes::FramePlanes&,
                             const RosPlace& place) {
  const Pose T_camera_world = result.cloud.T_world_sensor.inverse();
  std::vector<io::NamedPose> poses;
  if (!place.map.empty()) poses.push_back({place.map, place.camera, place.T_map_camera});
  if (frame.is_cloud() && !place.map.empty())
    poses = {{place.map, place.world, Pose::Identity()}};
  else
    poses.push_back({place.camera, place.world, T_camera_world});
  return io::ros_transforms("/tf", place.stamp_ns, poses);
}

}  // namespace

const std::vector<RosTopic>& ros_topics() {
  static const std::vector<RosTopic> topics = {
      {"/tf", "tf2_msgs/msg/TFMessage", poses_message},
      {"planes", "planescope_msgs/msg/PlaneArray", planes_message},
      {"markers", kMarkerArray, markers_message},
      {"points", "sensor_msgs/msg/PointCloud2", points_message}};
  return topics;
}

Json plane_array(const Frame&,
                 const planes::FrameResult& result,
                 const planes::FramePlanes& found,
                 const RosPlace& place) {
  Json planes = Json::array();
  for (std::size_t k = 0; k < found.summaries.size(); ++k) planes.push_back(ros_plane(found, k));
  const auto kerb_step = [](const planes::Kerb& kerb) {
    return ros_step(kerb.lower, kerb.upper, kerb.riser, kerb.rise_m, 0, kerb.nosing);
  };
  return {{"header", ros_header(place.stamp_ns, place.world)},
          {"sensor", io::ros_transform(result.cloud.T_world_sensor)},
          {"gravity_known", result.gravity.known()},
          {"planes", std::move(planes)},
          {"flights", list_of(found.stairs.flights, ros_flight)},
          {"kerbs", list_of(found.stairs.kerbs, kerb_step)},
          {"ramps", list_of(found.stairs.ramps, ros_ramp)}};
}

io::RosMessage ros_map_markers(const std::string& topic,
                               std::int64_t stamp_ns,
                               const std::vector<MarkedPlane>& planes) {
  Markers markers(stamp_ns);
  for (const MarkedPlane& plane : planes) {
    markers.begin_frame(plane.frame_id);
    markers.plane(plane);
  }
  return markers.message(topic);
}

io::RosMessage ros_path(const std::string& topic,
                        const std::string& map,
                        const std::vector<RosPose>& poses) {
  return io::ros_message(topic, "nav_msgs/msg/Path",
                         {{"header", ros_header(poses.front().stamp_ns, map)},
                          {"poses", list_of(poses, [&](const RosPose& pose) -> Json {
                             return {{"header", ros_header(pose.stamp_ns, map)},
                                     {"pose", io::ros_pose(pose.T_map_camera)}};
                           })}});
}

}  // namespace planescope::report
