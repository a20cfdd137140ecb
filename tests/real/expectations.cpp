#include "tests/real/expectations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/model/error.hpp"
#include "tests/real/levels.hpp"
#include "tests/real/sheets.hpp"

namespace planescope {
namespace {

using Json = nlohmann::json;
using Problems = std::vector<std::string>;

constexpr double kDegPerRad = 180 / M_PI;

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegPerRad;
}

double acute_angle_deg(const Vec3d& a, const Vec3d& b) {
  const double angle = angle_deg(a, b);
  return std::min(angle, 180 - angle);
}

Vec3d vec3_of(const Json& json) {
  return Vec3d(json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>());
}

// The plane on which most of the 5x5 pixels around [u, v] lie: one pixel alone may be a hole.
const OutputPlane& plane_at(const FrameOutput& output, const Json& pixel) {
  const int u = pixel.at(0).get<int>();
  const int v = pixel.at(1).get<int>();
  std::map<int, int> votes;
  for (int y = std::max(v - 2, 0); y <= std::min(v + 2, output.plane_ids.height - 1); ++y)
    for (int x = std::max(u - 2, 0); x <= std::min(u + 2, output.plane_ids.width - 1); ++x)
      if (const int id = output.plane_ids.at(x, y)) ++votes[id];
  int best = 0;
  for (const auto& [id, count] : votes)
    if (best == 0 || count > votes[best]) best = id;
  const OutputPlane* plane = plane_of_id(output, best);
  if (plane == nullptr) throw Error(fmt::format("no plane at pixel ({}, {})", u, v));
  return *plane;
}

void expect_near(
    double found, double expected, double tolerance, const std::string& what, Problems& problems) {
  if (!(std::abs(found - expected) <= tolerance))
    problems.push_back(
        fmt::format("{} is {:.4g}, expected {:.4g} +- {:.4g}", what, found, expected, tolerance));
}

void check_angle(const Json& e, const FrameOutput& output, Problems& problems) {
  const OutputPlane& a = plane_at(output, e.at("a"));
  const OutputPlane& b = plane_at(output, e.at("b"));
  expect_near(acute_angle_deg(a.normal, b.normal), e.at("deg").get<double>(),
              e.at("tolerance_deg").get<double>(),
              fmt::format("the angle between planes {} and {}", a.id, b.id), problems);
}

void check_label(const Json& e, const FrameOutput& output, Problems& problems) {
  const OutputPlane& plane = plane_at(output, e.at("at"));
  if (plane.label != e.at("label").get<std::string>())
    problems.push_back(fmt::format("plane {} is {}, expected {}", plane.id, plane.label,
                                   e.at("label").get<std::string>()));
}

std::vector<int> planes_at(const FrameOutput& output, const Json& pixels) {
  std::vector<int> ids;
  for (const Json& pixel : pixels) ids.push_back(plane_at(output, pixel).id);
  return ids;
}

void check_one_plane(const Json& e, const FrameOutput& output, Problems& problems) {
  const std::vector<int> ids = planes_at(output, e.at("at"));
  if (std::set<int>(ids.begin(), ids.end()).size() != 1)
    problems.push_back(
        fmt::format("the pixels lie on planes {}, expected one", fmt::join(ids, " ")));
}

void check_apart(const Json& e, const FrameOutput& output, Problems& problems) {
  const std::vector<int> ids = planes_at(output, e.at("at"));
  if (std::set<int>(ids.begin(), ids.end()).size() != ids.size())
    problems.push_back(
        fmt::format("the pixels lie on planes {}, expected each its own", fmt::join(ids, " ")));
}

void check_height(const Json& e, const FrameOutput& output, Problems& problems) {
  const OutputPlane& upper = plane_at(output, e.at("upper"));
  const OutputPlane& lower = plane_at(output, e.at("lower"));
  expect_near(upper.centroid.z() - lower.centroid.z(), e.at("m").get<double>(),
              e.at("tolerance_m").get<double>(),
              fmt::format("the height of plane {} above plane {}", upper.id, lower.id), problems);
}

void check_offset(const Json& e, const FrameOutput& output, Problems& problems) {
  const OutputPlane& a = plane_at(output, e.at("a"));
  const OutputPlane& b = plane_at(output, e.at("b"));
  expect_near(std::abs(a.normal.dot(b.centroid) - a.offset_m), e.at("m").get<double>(),
              e.at("tolerance_m").get<double>(),
              fmt::format("the distance of plane {} from plane {}", b.id, a.id), problems);
}

void check_gravity(const Json& e, const FrameOutput& output, Problems& problems) {
  expect_near(angle_deg(output.gravity, vec3_of(e.at("direction"))), 0,
              e.at("tolerance_deg").get<double>(),
              "the angle between gravity and its expected direction", problems);
}

void check_planes(const Json& e, const FrameOutput& output, Problems& problems) {
  const std::size_t least = e.at("least").get<std::size_t>();
  const std::size_t most = e.at("most").get<std::size_t>();
  if (output.planes.size() < least || output.planes.size() > most)
    problems.push_back(
        fmt::format("{} planes, expected {} to {}", output.planes.size(), least, most));
}

void check_coverage(const Json& e, const FrameOutput& output, Problems& problems) {
  std::size_t kept = 0, on_plane = 0;
  for (std::size_t i = 0; i < output.cloud.points.size(); ++i) {
    if (output.cloud.label[i] == 0) continue;  // cropped
    ++kept;
    on_plane += output.cloud.instance[i] != 0;
  }
  const double share = kept == 0 ? 0 : static_cast<double>(on_plane) / static_cast<double>(kept);
  if (share < e.at("least").get<double>())
    problems.push_back(
        fmt::format("{:.1f} % of {} points are on a plane, expected at least {:.1f} %", share * 100,
                    kept, e.at("least").get<double>() * 100));
}

void check_flights(const Json& e, const FrameOutput& output, Problems& problems) {
  const auto expected = e.at("heights").get<std::vector<OutputFlight>>();
  const auto all = [](const std::vector<OutputFlight>& flights) {
    std::string text;
    for (const OutputFlight& flight : flights)
      text += fmt::format(" [{:.3f}]", fmt::join(flight, " "));
    return text.empty() ? " none" : text;
  };
  const auto same = [&](const OutputFlight& found, const OutputFlight& of) {
    return std::ranges::equal(found, of, [&](double a, double b) {
      return std::abs(a - b) <= e.at("tolerance_m").get<double>();
    });
  };
  if (!std::ranges::equal(output.flights, expected, same))
    problems.push_back(
        fmt::format("treads of flights are at{}, expected{}", all(output.flights), all(expected)));
}

}  // namespace

Problems check_expectation(const Json& expectation, const FrameOutput& output) {
  const std::string kind = expectation.at("kind").get<std::string>();
  Problems problems;
  try {
    if (kind == "angle")
      check_angle(expectation, output, problems);
    else if (kind == "label")
      check_label(expectation, output, problems);
    else if (kind == "one_plane")
      check_one_plane(expectation, output, problems);
    else if (kind == "apart")
      check_apart(expectation, output, problems);
    else if (kind == "height")
      check_height(expectation, output, problems);
    else if (kind == "offset")
      check_offset(expectation, output, problems);
    else if (kind == "gravity")
      check_gravity(expectation, output, problems);
    else if (kind == "planes")
      check_planes(expectation, output, problems);
    else if (kind == "coverage")
      check_coverage(expectation, output, problems);
    else if (kind == "flights")
      check_flights(expectation, output, problems);
    else if (kind == "no_sheets")
      problems = find_sheets(output, SheetOptions{});
    else if (kind == "levels")
      problems = check_levels(output, expectation.at("y").get<double>(),
                              expectation.at("z").get<std::vector<double>>(),
                              expectation.at("tolerance_m").get<double>());
    else
      problems.push_back("unknown kind of expectation");
  } catch (const Error& error) {
    problems.push_back(error.what());
  }
  for (std::string& problem : problems) problem = expectation.dump() + ": " + problem;
  return problems;
}

Problems check_consistency(const FrameOutput& output) {
  Problems problems;
  std::map<int, std::int64_t> in_cloud, in_image;
  for (const std::int32_t id : output.cloud.instance)
    if (id != 0) ++in_cloud[id];
  for (const std::uint16_t id : output.plane_ids.data)
    if (id != 0) ++in_image[id];
  for (const OutputPlane& plane : output.planes) {
    if (std::abs(plane.normal.norm() - 1) > 1e-6)
      problems.push_back(
          fmt::format("plane {}: its normal has length {}", plane.id, plane.normal.norm()));
    if (in_cloud[plane.id] != plane.points)
      problems.push_back(fmt::format("plane {} has {} points in planes.json, {} in cloud.ply",
                                     plane.id, plane.points, in_cloud[plane.id]));
    if (!output.plane_ids.empty() && in_image[plane.id] != plane.points)
      problems.push_back(
          fmt::format("plane {} has {} points in planes.json, {} pixels in planes.png", plane.id,
                      plane.points, in_image[plane.id]));
    in_cloud.erase(plane.id);
    in_image.erase(plane.id);
  }
  for (const auto& counts : {in_cloud, in_image})
    for (const auto& [id, count] : counts)
      problems.push_back(fmt::format("plane {} with {} points is not in planes.json", id, count));
  return problems;
}

}  // namespace planescope
