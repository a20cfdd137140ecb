// Reads the output of segment and checks it against the expectations for real recordings.

#include "tests/real/expectations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"

namespace planescope {
namespace {

using Json = nlohmann::json;
using Problems = std::vector<std::string>;

Vec3d vec3_of(const Json& json) {
  return Vec3d(json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>());
}

/// Null for 0 (no plane) and for ids that are not in planes.json.
const OutputPlane* plane_of_id(const FrameOutput& output, int id) {
  const auto found = std::ranges::find(output.planes, id, &OutputPlane::id);
  return found == output.planes.end() ? nullptr : &*found;
}

}  // namespace

FrameOutput read_frame_output(const std::filesystem::path& folder) {
  FrameOutput output;
  std::ifstream file(folder / "planes.json");
  if (!file) throw Error((folder / "planes.json").string() + ": was not written");
  const Json json = Json::parse(file);
  output.gravity = vec3_of(json.at("gravity").at("direction"));
  for (const Json& entry : json.at("planes")) {
    OutputPlane plane;
    plane.id = entry.at("id").get<int>();
    plane.label = entry.at("label").get<std::string>();
    plane.normal = vec3_of(entry.at("normal"));
    plane.centroid = vec3_of(entry.at("centroid"));
    plane.offset_m = entry.at("offset_m").get<double>();
    plane.points = entry.at("points").get<std::int64_t>();
    output.planes.push_back(plane);
  }
  for (const Json& entry : json.at("flights")) {
    OutputFlight& heights = output.flights.emplace_back();
    for (const Json& step : entry.at("steps"))
      heights.push_back((heights.empty() ? 0 : heights.back()) + step.at("rise_m").get<double>());
  }
  if (std::filesystem::exists(folder / "planes.png"))
    output.plane_ids = io::read_png_16(folder / "planes.png");
  output.cloud = io::read_cloud_file(folder / "cloud.ply");
  return output;
}

namespace {

constexpr double kSliceHalfWidth = 0.03;  // [m]
// Horizontal: within 30 degrees. Steeper planes are risers, which connect two levels.
constexpr double kMinNormalZ = 0.866;
constexpr std::size_t kMinPoints = 20;  // fewer points in the slice are ignored

// A horizontal plane where it crosses the slice.
struct Crossing {
  int id = 0;
  double z = 0;                    // of the plane itself, at the center of its points
  double lowest = 0, highest = 0;  // 5th and 95th percentile of its points
};

double percentile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<Crossing> crossings(const FrameOutput& output, double y_m) {
  std::map<int, std::vector<Vec3d>> slices;
  for (std::size_t i = 0; i < output.cloud.points.size(); ++i) {
    const Vec3d p = output.cloud.points[i].cast<double>() + output.cloud.origin;
    if (output.cloud.instance[i] != 0 && std::abs(p.y() - y_m) < kSliceHalfWidth)
      slices[output.cloud.instance[i]].push_back(p);
  }
  std::vector<Crossing> found;
  for (const auto& [id, points] : slices) {
    const OutputPlane* plane = plane_of_id(output, id);
    if (plane == nullptr || std::abs(plane->normal.z()) < kMinNormalZ || points.size() < kMinPoints)
      continue;
    std::vector<double> x, z;
    for (const Vec3d& p : points) {
      x.push_back(p.x());
      z.push_back(p.z());
    }
    const Vec3d& n = plane->normal;
    Crossing crossing;
    crossing.id = id;
    crossing.z = (plane->offset_m - n.x() * percentile(x, 0.5) - n.y() * y_m) / n.z();
    crossing.lowest = percentile(z, 0.05);
    crossing.highest = percentile(z, 0.95);
    found.push_back(crossing);
  }
  return found;
}

}  // namespace

std::vector<std::string> check_levels(const FrameOutput& output,
                                      double y_m,
                                      const std::vector<double>& levels_m,
                                      double tolerance_m) {
  const std::vector<Crossing> found = crossings(output, y_m);
  std::string seen;
  for (const Crossing& c : found)
    seen += fmt::format(" {}: {:.3f} ({:.3f}..{:.3f})", c.id, c.z, c.lowest, c.highest);
  std::vector<std::string> problems;
  for (const double level : levels_m) {
    const auto near = std::count_if(found.begin(), found.end(), [&](const Crossing& c) {
      return std::abs(c.z - level) <= tolerance_m;
    });
    if (near == 0)
      problems.push_back(
          fmt::format("no horizontal plane at z = {:.2f}; there are{}", level, seen));
  }
  for (const Crossing& c : found) {
    const auto spanned = std::count_if(levels_m.begin(), levels_m.end(), [&](double level) {
      return c.lowest - tolerance_m <= level && level <= c.highest + tolerance_m;
    });
    if (spanned > 1)
      problems.push_back(fmt::format("plane {} spans {} levels, from z = {:.3f} to {:.3f}", c.id,
                                     spanned, c.lowest, c.highest));
  }
  return problems;
}

namespace {

using Cells = std::set<std::pair<int, int>>;

// Cells occupied by a plane's points, projected onto `onto`.
Cells occupied_cells(const FrameOutput& output, int id, const OutputPlane& onto, double cell_m) {
  const Vec3d u = onto.normal.unitOrthogonal();
  const Vec3d v = onto.normal.cross(u);
  Cells cells;
  for (std::size_t i = 0; i < output.cloud.points.size(); ++i) {
    if (output.cloud.instance[i] != id) continue;
    const Vec3d p = output.cloud.points[i].cast<double>() + output.cloud.origin;
    cells.emplace(static_cast<int>(std::floor(p.dot(u) / cell_m)),
                  static_cast<int>(std::floor(p.dot(v) / cell_m)));
  }
  return cells;
}

double overlap(const Cells& a, const Cells& b) {
  std::size_t both = 0;
  for (const auto& cell : a) both += b.count(cell);
  return static_cast<double>(both) / static_cast<double>(std::min(a.size(), b.size()));
}

}  // namespace

std::vector<std::string> find_sheets(const FrameOutput& output, const SheetOptions& options) {
  std::vector<std::string> problems;
  const double min_cosine = std::cos(options.max_angle_deg * M_PI / 180);
  for (std::size_t i = 0; i < output.planes.size(); ++i) {
    for (std::size_t j = i + 1; j < output.planes.size(); ++j) {
      const OutputPlane& a = output.planes[i];
      const OutputPlane& b = output.planes[j];
      if (a.label != b.label || std::min(a.points, b.points) < options.min_points) continue;
      if (std::abs(a.normal.dot(b.normal)) < min_cosine) continue;
      const double offset = std::min(std::abs(a.normal.dot(b.centroid) - a.offset_m),
                                     std::abs(b.normal.dot(a.centroid) - b.offset_m));
      if (offset > options.max_offset_m) continue;
      const double share = overlap(occupied_cells(output, a.id, a, options.cell_m),
                                   occupied_cells(output, b.id, a, options.cell_m));
      if (share > options.min_overlap)
        problems.push_back(fmt::format(
            "planes {} and {} ({} and {} points) are sheets of one surface: {:.1f} mm apart, "
            "{:.0f} % of the smaller is covered by the other",
            a.id, b.id, a.points, b.points, offset * 1e3, share * 100));
    }
  }
  return problems;
}

namespace {

constexpr double kDegPerRad = 180 / M_PI;

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegPerRad;
}

double acute_angle_deg(const Vec3d& a, const Vec3d& b) {
  const double angle = angle_deg(a, b);
  return std::min(angle, 180 - angle);
}

// The plane of most of the 5x5 pixels around [u, v], because a single pixel may be a hole.
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

using Check = void (*)(const Json&, const FrameOutput&, Problems&);
const std::map<std::string, Check> kChecks = {
    {"angle", check_angle},     {"label", check_label},   {"one_plane", check_one_plane},
    {"apart", check_apart},     {"height", check_height}, {"offset", check_offset},
    {"gravity", check_gravity}, {"planes", check_planes}, {"coverage", check_coverage},
    {"flights", check_flights}};

}  // namespace

Problems check_expectation(const Json& expectation, const FrameOutput& output) {
  const std::string kind = expectation.at("kind").get<std::string>();
  Problems problems;
  try {
    if (const auto check = kChecks.find(kind); check != kChecks.end())
      check->second(expectation, output, problems);
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
