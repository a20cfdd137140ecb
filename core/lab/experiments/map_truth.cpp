#include "core/lab/experiments/map_truth.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
// A plane of the map matches a face within these limits; smaller planes are ignored.
constexpr double kNear_m = 0.15, kNear_deg = 10, kLeastArea_m2 = 0.04;
// A face is in view when its center is near the optical axis and it is not seen edge-on.
constexpr double kView_deg = 30, kMostIncidence_deg = 75;

double degrees(double radians) { return radians * 180 / std::numbers::pi; }
double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

struct Face {
  std::string name;
  Vec3d center, normal;  // outwards
  Vec3d along[2];
  double half[2];

  bool is_near(const Vec3d& p) const {
    const Vec3d d = p - center;
    return std::abs(d.dot(normal)) <= kNear_m && std::abs(d.dot(along[0])) <= half[0] + kNear_m &&
           std::abs(d.dot(along[1])) <= half[1] + kNear_m;
  }
};

std::vector<Face> faces_of(std::span<const Cuboid> cuboids) {
  const double everywhere = std::numeric_limits<double>::infinity();
  std::vector<Face> faces{{"floor",
                           Vec3d::Zero(),
                           Vec3d::UnitZ(),
                           {Vec3d::UnitX(), Vec3d::UnitY()},
                           {everywhere, everywhere}}};
  for (std::size_t k = 0; k < cuboids.size(); ++k) {
    const Cuboid& box = cuboids[k];
    const Mat3d R = Eigen::AngleAxisd(box.yaw, Vec3d::UnitZ()).toRotationMatrix();
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {1, -1}) {
        if (axis == 2 && side < 0) continue;  // the bottom face touches the floor
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const Vec3d normal = side * R.col(axis);
        const std::string name =
            fmt::format("cuboid {} {}{}", k + 1, side > 0 ? '+' : '-', "xyz"[axis]);
        faces.push_back({name,
                         box.center + box.half[axis] * normal,
                         normal,
                         {R.col(u), R.col(v)},
                         {box.half[u], box.half[v]}});
      }
  }
  return faces;
}

struct MapPlane {
  Vec3d normal, centroid;
  double area_m2 = 0;
};

Vec3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Error not_a_map(const fs::path& file, const Json::exception& problem) {
  return Error(fmt::format("{}: {}, expected what planescope map wrote", file.string(),
                           json_problem(problem)));
}

/// The largest first.
std::vector<MapPlane> read_planes(const fs::path& file) {
  std::vector<MapPlane> planes;
  const Json json = read_json<Json>(file, kMostBytes);
  try {
    for (const Json& plane : json.at("planes"))
      if (plane.at("segment") == 0 && plane.at("state") != "gone")
        planes.push_back({vector_of(plane.at("normal")), vector_of(plane.at("centroid")),
                          plane.at("area_m2").get<double>()});
  } catch (const Json::exception& problem) {
    throw not_a_map(file, problem);
  }
  std::ranges::stable_sort(planes, std::greater(), &MapPlane::area_m2);
  return planes;
}

/// T_world_camera of the frames that went into the first segment.
std::vector<Pose> read_poses(const fs::path& map) {
  const fs::path file = map / "tracks.json";
  const Json json = read_json<Json>(file, kMostBytes);
  const world::Trajectory trajectory = world::read_trajectory(map / "poses.tum");
  std::vector<Pose> poses;
  try {
    for (const Json& frame : json.at("frames")) {
      if (frame.at("segment") != 0 || frame.contains("set_aside")) continue;
      if (const auto* pose = world::pose_of(trajectory, frame.at("frame").get<int>()))
        poses.push_back(pose->T_world_camera);
    }
  } catch (const Json::exception& problem) {
    throw not_a_map(file, problem);
  }
  return poses;
}

bool looks_at(const Pose& T_world_camera, const Face& face) {
  const Vec3d to = face.center - T_world_camera.translation();
  return to.dot(T_world_camera.linear().col(2)) > cosine(kView_deg) * to.norm() &&
         -to.dot(face.normal) > cosine(kMostIncidence_deg) * to.norm();
}

}  // namespace

std::vector<Cuboid> read_cuboids(const fs::path& file) {
  std::vector<Cuboid> cuboids;
  for (const TextLine& line : read_text_lines(file, kMostBytes)) {
    if (line.words.empty()) continue;
    const std::vector<double> n = numbers_in(file, line, 7, "x y z yaw and three half sizes");
    const Cuboid& box = cuboids.emplace_back(Cuboid{{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}});
    if (!(box.half.minCoeff() > 0)) fail_at(file, line, "a half size is not above 0");
  }
  if (cuboids.empty())
    throw Error(file.string() + ": holds no cuboid, expected lines of x y z yaw and half sizes");
  return cuboids;
}

MapTruthScore measure_map_truth(const fs::path& map, std::span<const Cuboid> cuboids) {
  const std::vector<Face> faces = faces_of(cuboids);
  const std::vector<MapPlane> planes = read_planes(map / "map.json");
  const std::vector<Pose> poses = read_poses(map);
  MapTruthScore score;
  for (const Face& face : faces) {
    FaceScore& of = score.faces.emplace_back();
    of.name = face.name;
    for (const Pose& T_world_camera : poses)
      of.frames += face.name == "floor" || looks_at(T_world_camera, face);
  }
  for (const MapPlane& plane : planes) {
    if (plane.area_m2 < kLeastArea_m2) continue;
    const auto off_m = [&](const Face& face) {
      return std::abs(plane.normal.dot(face.normal)) >= cosine(kNear_deg) &&
                     face.is_near(plane.centroid)
                 ? std::abs((plane.centroid - face.center).dot(face.normal))
                 : std::numeric_limits<double>::infinity();
    };
    const auto face = std::ranges::min_element(faces, {}, off_m);
    if (std::isinf(off_m(*face))) {
      ++score.elsewhere;
      continue;
    }
    FaceScore& of = score.faces[face - faces.begin()];
    of.area_m2 += plane.area_m2;
    if (of.planes++ > 0) continue;
    of.offset_m = (plane.centroid - face->center).dot(face->normal);
    of.angle_deg = degrees(std::acos(std::min(1.0, std::abs(plane.normal.dot(face->normal)))));
  }
  return score;
}

Table map_truth_table(const MapTruthScore& score, const std::string& name) {
  Table table;
  table.title = "Map " + name + " against measured cuboids";
  int missing = 0, doubled = 0;
  for (const FaceScore& face : score.faces)
    missing += face.is_missing(), doubled += std::max(0, face.planes - 1);
  table.note = fmt::format(
      "{} missing, {} more than once, {} elsewhere. Frames: those that look at the middle of the "
      "face. Planes: of the map, at most {:.0f} cm and {:.0f} degrees from it. Offset: of the "
      "largest one's centroid, outwards.",
      missing, doubled, score.elsewhere, 100 * kNear_m, kNear_deg);
  table.columns = {"face", "frames", "planes", "area [m2]", "offset [mm]", "angle [deg]"};
  for (const FaceScore& face : score.faces)
    table.rows.push_back({face.name, fmt::format("{}", face.frames), fmt::format("{}", face.planes),
                          fixed(face.area_m2, 2),
                          face.planes > 0 ? fixed(1000 * face.offset_m, 1) : "-",
                          face.planes > 0 ? fixed(face.angle_deg, 2) : "-"});
  return table;
}

}  // namespace planescope::lab
