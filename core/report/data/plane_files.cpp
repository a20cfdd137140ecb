// Writes a frame's planes in other tools' formats, and all output files of a frame.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/report/data/ros_planes.hpp"
#include "core/report/data/segment_files.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;
using planes::Outline;
using planes::Polygon;
using planes::PolygonRing;

constexpr double kDegrees = 180 / std::numbers::pi;  // per radian

Json quaternion_json(const Eigen::Quaterniond& q) {
  Json json = io::ros_point(q.vec());
  json["w"] = rounded(q.w());
  return json;
}

template <typename Things, typename ToJson>
Json list_json(const Things& things, const ToJson& to_json) {
  Json list = Json::array();
  for (const auto& thing : things) list.push_back(to_json(thing));
  return list;
}

// ---- GeoJSON ----

Json positions_json(const Outline& outline, const PolygonRing& ring) {
  Json positions = Json::array();
  for (const Vec2d& corner : ring) positions.push_back(vector_json(outline.world(corner)));
  positions.push_back(positions.front());
  return positions;
}

Json feature_json(const planes::PlaneSummary& plane,
                  const char* kind,
                  const Outline& outline,
                  const planes::Polygons& polygons) {
  Json coordinates = Json::array();
  for (const Polygon& polygon : polygons) {
    Json rings = Json::array({positions_json(outline, polygon.outer)});
    for (const PolygonRing& hole : polygon.holes) rings.push_back(positions_json(outline, hole));
    coordinates.push_back(rings);
  }
  return {{"type", "Feature"},
          {"properties",
           {{"plane", plane.id},
            {"kind", kind},
            {"label", to_string(plane.label)},
            {"undecided", plane.undecided},
            {"normal", vector_json(plane.normal)},
            {"offset_m", rounded(plane.offset_m)}}},
          {"geometry", {{"type", "MultiPolygon"}, {"coordinates", coordinates}}}};
}

std::string geojson_text(const planes::FramePlanes& found) {
  Json features = Json::array();
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const Outline& outline = found.outlines[k];
    const planes::Foothold& foothold = found.footholds[k];
    features.push_back(
        feature_json(found.summaries[k], "outline", outline, planes::polygons_of(outline)));
    if (!foothold.space) continue;
    Json foot = feature_json(found.summaries[k], "foot", outline, foothold.space->area);
    foot["properties"]["steppable"] = foothold.steppable;
    features.push_back(foot);
  }
  return Json({{"type", "FeatureCollection"}, {"features", features}}).dump() + "\n";
}

// ---- Meshes ----

std::string obj_text(const planes::FramePlanes& found) {
  std::string text;
  int first = 1;  // vertices are numbered across the whole file
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const planes::PlaneSummary& plane = found.summaries[k];
    const planes::Mesh mesh = planes::mesh_of(found.outlines[k]);
    const Vec3d& n = plane.normal;
    text += fmt::format("o plane_{}_{}\nvn {:.9f} {:.9f} {:.9f}\n", plane.id,
                        to_string(plane.label), n.x(), n.y(), n.z());
    for (const Vec3d& v : mesh.vertices)
      text += fmt::format("v {:.9f} {:.9f} {:.9f}\n", v.x(), v.y(), v.z());
    for (const auto& [a, b, c] : mesh.triangles)
      text += fmt::format("f {0}//{3} {1}//{3} {2}//{3}\n", first + a, first + b, first + c, k + 1);
    first += static_cast<int>(mesh.vertices.size());
  }
  return text;
}

std::string ply_text(const planes::FramePlanes& found) {
  std::string vertices, faces;
  int vertex_count = 0, face_count = 0;
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const planes::PlaneSummary& plane = found.summaries[k];
    const planes::Mesh mesh = planes::mesh_of(found.outlines[k]);
    for (const Vec3d& v : mesh.vertices)
      vertices += fmt::format("{:.9f} {:.9f} {:.9f}\n", v.x(), v.y(), v.z());
    for (const auto& [a, b, c] : mesh.triangles)
      faces += fmt::format("3 {} {} {} {} {}\n", vertex_count + a, vertex_count + b,
                           vertex_count + c, plane.id, static_cast<int>(plane.label));
    vertex_count += static_cast<int>(mesh.vertices.size());
    face_count += static_cast<int>(mesh.triangles.size());
  }
  return fmt::format(
             "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
             "property double z\nelement face {}\nproperty list uchar int vertex_indices\n"
             "property int instance\nproperty uchar label\nend_header\n",
             vertex_count, face_count) +
         vertices + faces;
}

// ---- convex_plane_decomposition_msgs/PlanarTerrain ----

Json points_json(const PolygonRing& ring) {
  return {{"points", list_json(ring, [](const Vec2d& p) -> Json {
             return {{"x", rounded(p.x())}, {"y", rounded(p.y())}};
           })}};
}

Json with_holes_json(const Polygon& polygon) {
  return {{"outer_boundary", points_json(polygon.outer)},
          {"holes", list_json(polygon.holes, points_json)}};
}

/// Coordinates on the plane: the pose transforms them to the world, with z along the normal.
Json pose_json(const Outline& outline) {
  Mat3d axes;
  axes << outline.basis.u, outline.basis.v, outline.basis.u.cross(outline.basis.v);
  return {{"position", io::ros_point(outline.origin)},
          {"orientation", quaternion_json(Eigen::Quaterniond(axes))}};
}

Json box_json(const PolygonRing& ring) {
  Eigen::AlignedBox2d box;
  for (const Vec2d& p : ring) box.extend(p);
  return {{"min_x", rounded(box.min().x())},
          {"min_y", rounded(box.min().y())},
          {"max_x", rounded(box.max().x())},
          {"max_y", rounded(box.max().y())}};
}

/// One region for each part of a plane, since the message has one boundary.
std::string planar_terrain_text(const planes::FramePlanes& found) {
  Json regions = Json::array();
  for (std::size_t k = 0; k < found.outlines.size(); ++k) {
    const Outline& outline = found.outlines[k];
    for (const Polygon& part : planes::polygons_of(outline)) {
      Json insets = Json::array();
      if (const auto& space = found.footholds[k].space)
        for (const Polygon& inset : space->area)
          if (planes::is_in(part.outer, inset.outer.front()))
            insets.push_back(with_holes_json(inset));
      regions.push_back({{"plane_parameters", pose_json(outline)},
                         {"bbox2d", box_json(part.outer)},
                         {"boundary", with_holes_json(part)},
                         {"insets", insets}});
    }
  }
  return Json({{"planarRegions", regions}}).dump() + "\n";
}

// ---- CSV ----

std::string csv_of(double value) {
  return std::isfinite(value) ? fmt::format("{}", rounded(value)) : std::string();
}

std::string csv_text(const planes::FramePlanes& found) {
  std::string text =
      "id,label,normal_x,normal_y,normal_z,centroid_x,centroid_y,centroid_z,offset_m,points,voxels,"
      "rms_m,area_m2,outline_area_m2,slope_deg,rough_rms_m,rough_step_m,support,best_x,best_y,"
      "best_z,clearance_m,tilt_sigma_1_deg,tilt_sigma_2_deg,offset_sigma_m,steppable,why_not,"
      "foot_area_m2,pieces,margin,undecided\n";
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const planes::PlaneSummary& s = found.summaries[k];
    const planes::Foothold& foothold = found.footholds[k];
    const planes::Surface& surface = foothold.surface;
    const planes::Certainty& certainty = foothold.certainty;
    text += fmt::format("{},{}", s.id, to_string(s.label));
    const auto add = [&](const auto&... values) { ((text += ',', text += csv_of(values)), ...); };
    const auto add_vector = [&](const Vec3d& v) { add(v.x(), v.y(), v.z()); };
    add_vector(s.normal);
    add_vector(s.centroid);
    add(s.offset_m);
    text += fmt::format(",{},{}", s.points, s.voxels);
    add(s.rms_m, s.area_m2, found.outlines[k].area_m2, surface.slope_deg, surface.rough_rms_m,
        surface.rough_step_m, surface.support);
    add_vector(surface.best_place);
    add(surface.clearance_m, certainty.sigma_tilt_rad[0] * kDegrees,
        certainty.sigma_tilt_rad[1] * kDegrees, certainty.sigma_offset_m);
    if (foothold.space)
      text += fmt::format(",{},\"{}\",{},{}", foothold.steppable, foothold.why_not,
                          csv_of(foothold.space->area_m2), foothold.space->pieces.size());
    else
      text += ",,,,";
    text += fmt::format(",{},{}\n", csv_of(s.margin), s.undecided);
  }
  return text;
}

}  // namespace

const std::vector<PlaneFormat>& plane_formats() {
  static const std::vector<PlaneFormat> formats = {
      {"geojson", "planes.geojson", "outlines and footholds as polygons", geojson_text},
      {"obj", "planes.obj", "outlines as triangles", obj_text},
      {"ply", "planes.ply", "outlines as triangles with plane id and label", ply_text},
      {"planar-terrain", "planar_terrain.json",
       "the fields of convex_plane_decomposition_msgs/PlanarTerrain", planar_terrain_text},
      {"csv", "planes.csv", "one line per plane", csv_text},
      {"svg", "planes.svg", "a drawing of each plane", planes_svg}};
  return formats;
}

void write_plane_files(const std::filesystem::path& dir,
                       const std::vector<std::string>& formats,
                       const planes::FramePlanes& found) {
  for (const PlaneFormat& format : plane_formats())
    if (std::ranges::find(formats, format.name) != formats.end())
      write_file_text(dir / format.file, format.text(found));
}

std::string ros_json(const Frame& frame,
                     const planes::FrameResult& result,
                     const planes::FramePlanes& found) {
  return plane_array(frame, result, found, {.stamp_ns = io::ros_stamp(frame.timestamp_s)}).dump();
}

// ---- Output of `planescope segment` ----

std::filesystem::path frame_folder(int frame_index) {
  return std::filesystem::path("frames") / fmt::format("{:06}", frame_index);
}

Image16 plane_image(const Frame& frame, const planes::FrameResult& result) {
  Image16 image(frame.depth.width, frame.depth.height);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    image.data[result.cloud.source[i]] =
        static_cast<std::uint16_t>(std::min(result.plane_of[i], 65535));
  return image;
}

Image16 track_image(const Frame& frame,
                    const planes::FrameResult& result,
                    std::span<const int> tracks) {
  Image16 image = plane_image(frame, result);
  for (std::uint16_t& id : image.data)
    if (id > 0) id = static_cast<std::uint16_t>(std::min(tracks[id - 1], 65535));
  return image;
}

PointSet labeled_cloud(const Frame& frame, const planes::FrameResult& result) {
  const planes::Cloud& cloud = result.cloud;
  const std::size_t n = frame.is_cloud() ? frame.cloud->points.size() : cloud.points.size();
  // World coordinates near zero fit a float; with a distant origin they are written as doubles.
  const bool far_away = cloud.origin.norm() > 100;
  PointSet set;
  if (far_away) set.origin = cloud.origin;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  set.points.assign(n, Vec3f(kNan, kNan, kNan));  // invalid measurements stay invalid
  set.label.assign(n, 0);
  const std::uint32_t* const place_of = frame.is_cloud() ? cloud.source.data() : nullptr;
  const auto place = [place_of](std::size_t i) { return place_of ? place_of[i] : i; };
  const Vec3d shift = far_away ? Vec3d::Zero().eval() : cloud.origin;
  if (place_of || !shift.isZero(0))
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      set.points[place(i)] = (cloud.points[i].cast<double>() + shift).cast<float>();
  else
    std::ranges::transform(cloud.points, set.points.begin(),
                           [](const Vec3f& p) { return p + Vec3f::Zero(); });  // -0 becomes 0
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (const std::uint32_t voxel = result.voxels.voxel_of[i]; voxel != planes::kNoVoxel)
      set.label[place(i)] = static_cast<std::uint8_t>(result.classification.labels[voxel]);
  if (!place_of) {
    set.instance = result.plane_of;
    return set;
  }
  set.instance.assign(n, 0);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) set.instance[place(i)] = result.plane_of[i];
  return set;
}

void write_segment_files(const std::filesystem::path& dir,
                         const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::FramePlanes& found,
                         const planes::PipelineOptions& options,
                         const std::vector<std::string>& also) {
  write_file_text(dir / "timings.json", planes::timings_json(result.timings));
  write_file_text(dir / "planes.json", planes::planes_json(frame, result, found, options));
  write_plane_files(dir, also, found);
  if (!frame.is_cloud()) io::write_png(dir / "planes.png", plane_image(frame, result));
  if (!frame.is_cloud() && found.tracks)
    io::write_png(dir / "tracks.png", track_image(frame, result, *found.tracks));
  io::write_ply(dir / "cloud.ply", labeled_cloud(frame, result));
}

}  // namespace planescope::report
