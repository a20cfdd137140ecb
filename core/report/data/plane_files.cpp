#include "core/report/data/plane_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/report/data/plane_svg.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;
using planes::Outline;
using planes::Polygon;
using planes::PolygonRing;

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
  int first = 1;  // vertices are counted over the whole file
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
  Json points = Json::array();
  for (const Vec2d& p : ring) points.push_back({{"x", rounded(p.x())}, {"y", rounded(p.y())}});
  return {{"points", points}};
}

Json with_holes_json(const Polygon& polygon) {
  Json holes = Json::array();
  for (const PolygonRing& hole : polygon.holes) holes.push_back(points_json(hole));
  return {{"outer_boundary", points_json(polygon.outer)}, {"holes", holes}};
}

/// Coordinates on the plane: the pose takes them to the world, z along the normal.
Json pose_json(const Outline& outline) {
  Mat3d axes;
  axes << outline.basis.u, outline.basis.v, outline.basis.u.cross(outline.basis.v);
  const Eigen::Quaterniond q(axes);
  const Vec3d& p = outline.origin;
  return {{"position", {{"x", rounded(p.x())}, {"y", rounded(p.y())}, {"z", rounded(p.z())}}},
          {"orientation",
           {{"x", rounded(q.x())},
            {"y", rounded(q.y())},
            {"z", rounded(q.z())},
            {"w", rounded(q.w())}}}};
}

Json box_json(const PolygonRing& ring) {
  Eigen::AlignedBox2d box;
  for (const Vec2d& p : ring) box.extend(p);
  return {{"min_x", rounded(box.min().x())},
          {"min_y", rounded(box.min().y())},
          {"max_x", rounded(box.max().x())},
          {"max_y", rounded(box.max().y())}};
}

/// A region for each part of a plane: the message has one boundary.
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

std::string csv_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", rounded(value)) : std::string();
}
std::string csv_vector(const Vec3d& v) {
  return fmt::format("{},{},{}", csv_number(v.x()), csv_number(v.y()), csv_number(v.z()));
}

std::string csv_text(const planes::FramePlanes& found) {
  std::string text =
      "id,label,normal_x,normal_y,normal_z,centroid_x,centroid_y,centroid_z,offset_m,points,voxels,"
      "rms_m,area_m2,outline_area_m2,slope_deg,rough_rms_m,rough_step_m,support,best_x,best_y,"
      "best_z,clearance_m,tilt_sigma_1_deg,tilt_sigma_2_deg,offset_sigma_m,steppable,why_not,"
      "foot_area_m2,pieces,margin,undecided\n";
  constexpr double kDeg = 180 / M_PI;
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const planes::PlaneSummary& s = found.summaries[k];
    const planes::Foothold& foothold = found.footholds[k];
    const planes::Surface& surface = foothold.surface;
    const planes::Certainty& certainty = foothold.certainty;
    const std::vector<std::string> cells = {std::to_string(s.id),
                                            to_string(s.label),
                                            csv_vector(s.normal),
                                            csv_vector(s.centroid),
                                            csv_number(s.offset_m),
                                            std::to_string(s.points),
                                            std::to_string(s.voxels),
                                            csv_number(s.rms_m),
                                            csv_number(s.area_m2),
                                            csv_number(found.outlines[k].area_m2),
                                            csv_number(surface.slope_deg),
                                            csv_number(surface.rough_rms_m),
                                            csv_number(surface.rough_step_m),
                                            csv_number(surface.support),
                                            csv_vector(surface.best_place),
                                            csv_number(surface.clearance_m),
                                            csv_number(certainty.sigma_tilt_rad[0] * kDeg),
                                            csv_number(certainty.sigma_tilt_rad[1] * kDeg),
                                            csv_number(certainty.sigma_offset_m)};
    text += fmt::format("{}", fmt::join(cells, ","));
    if (foothold.space)
      text += fmt::format(",{},\"{}\",{},{}", foothold.steppable, foothold.why_not,
                          csv_number(foothold.space->area_m2), foothold.space->pieces.size());
    else
      text += ",,,,";
    text += fmt::format(",{},{}\n", csv_number(s.margin), s.undecided);
  }
  return text;
}

}  // namespace

const std::vector<PlaneFormat>& plane_formats() {
  static const std::vector<PlaneFormat> formats = {
      {"geojson", "planes.geojson", "outlines and places for a foot as GeoJSON has polygons",
       geojson_text},
      {"obj", "planes.obj", "outlines as triangles", obj_text},
      {"ply", "planes.ply", "the same, with plane and label of each", ply_text},
      {"planar-terrain", "planar_terrain.json",
       "the fields of convex_plane_decomposition_msgs/PlanarTerrain", planar_terrain_text},
      {"csv", "planes.csv", "a line for each plane", csv_text},
      {"svg", "planes.svg", "a picture of each plane", planes_svg}};
  return formats;
}

void write_plane_files(const std::filesystem::path& dir,
                       const std::vector<std::string>& formats,
                       const planes::FramePlanes& found) {
  for (const PlaneFormat& format : plane_formats())
    if (std::ranges::find(formats, format.name) != formats.end())
      write_file_text(dir / format.file, format.text(found));
}

}  // namespace planescope::report
