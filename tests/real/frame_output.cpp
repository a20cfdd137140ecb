#include "tests/real/frame_output.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"

namespace planescope {
namespace {

Vec3d to_vec3(const nlohmann::json& json) {
  return Vec3d(json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>());
}

}  // namespace

FrameOutput read_frame_output(const std::filesystem::path& folder) {
  FrameOutput output;
  output.folder = folder;
  std::ifstream file(folder / "planes.json");
  if (!file) throw Error((folder / "planes.json").string() + ": was not written");
  const nlohmann::json json = nlohmann::json::parse(file);
  output.gravity = to_vec3(json.at("gravity").at("direction"));
  for (const nlohmann::json& entry : json.at("planes")) {
    OutputPlane plane;
    plane.id = entry.at("id").get<int>();
    plane.label = entry.at("label").get<std::string>();
    plane.normal = to_vec3(entry.at("normal"));
    plane.centroid = to_vec3(entry.at("centroid"));
    plane.offset_m = entry.at("offset_m").get<double>();
    plane.points = entry.at("points").get<std::int64_t>();
    output.planes.push_back(plane);
  }
  for (const nlohmann::json& entry : json.at("flights")) {
    OutputFlight& heights = output.flights.emplace_back();
    for (const nlohmann::json& step : entry.at("steps"))
      heights.push_back((heights.empty() ? 0 : heights.back()) + step.at("rise_m").get<double>());
  }
  if (std::filesystem::exists(folder / "planes.png"))
    output.plane_ids = io::read_png_16(folder / "planes.png");
  output.cloud = io::read_cloud_file(folder / "cloud.ply");
  return output;
}

const OutputPlane* plane_of_id(const FrameOutput& output, int id) {
  const auto found = std::find_if(output.planes.begin(), output.planes.end(),
                                  [&](const auto& p) { return p.id == id; });
  return found == output.planes.end() ? nullptr : &*found;
}

}  // namespace planescope
