#include "core/world/files/observed_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::world {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.observed/5";

Json vector_bits(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }
Vec3d vector_of_bits(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json ring_bits(const planes::PolygonRing& ring) {
  Json json = Json::array();
  for (const Vec2d& p : ring) {
    json.push_back(p.x());
    json.push_back(p.y());
  }
  return json;
}
planes::PolygonRing ring_of_bits(const Json& json) {
  planes::PolygonRing ring;
  for (std::size_t i = 0; i + 1 < json.size(); i += 2)
    ring.emplace_back(json[i].get<double>(), json[i + 1].get<double>());
  return ring;
}

Json rings_bits(const std::vector<planes::PolygonRing>& rings) {
  Json json = Json::array();
  for (const planes::PolygonRing& ring : rings) json.push_back(ring_bits(ring));
  return json;
}
std::vector<planes::PolygonRing> rings_of_bits(const Json& json) {
  std::vector<planes::PolygonRing> rings;
  for (const Json& ring : json) rings.push_back(ring_of_bits(ring));
  return rings;
}

Json outline_bits(const planes::Outline& outline) {
  Json parts = Json::array();
  for (const planes::Outline::Part& part : outline.parts)
    parts.push_back({ring_bits(part.outer), rings_bits(part.holes), rings_bits(part.unknown)});
  return {{"origin", vector_bits(outline.origin)},
          {"u", vector_bits(outline.basis.u)},
          {"v", vector_bits(outline.basis.v)},
          {"area_m2", outline.area_m2},
          {"parts", parts}};
}
planes::Outline outline_of_bits(const Json& json) {
  planes::Outline outline;
  outline.origin = vector_of_bits(json.at("origin"));
  outline.basis = {vector_of_bits(json.at("u")), vector_of_bits(json.at("v"))};
  outline.area_m2 = json.at("area_m2").get<double>();
  for (const Json& part : json.at("parts"))
    outline.parts.push_back(
        {ring_of_bits(part.at(0)), rings_of_bits(part.at(1)), rings_of_bits(part.at(2))});
  return outline;
}

Json plane_bits(const ObservedPlane& plane) {
  const Moments& m = plane.moments;
  const planes::Certainty& c = plane.certainty;
  return {
      {"label", static_cast<int>(plane.label)},
      {"minor", plane.minor},
      {"normal", vector_bits(plane.normal)},
      {"centroid", vector_bits(plane.centroid)},
      {"moments", {m.count, m.sum.x(), m.sum.y(), m.sum.z(), m.xx, m.xy, m.xz, m.yy, m.yz, m.zz}},
      {"certainty",
       {vector_bits(c.eigenvalues_m2), vector_bits(c.axes[0]), vector_bits(c.axes[1]),
        Json{c.sigma_m, c.sigma_tilt_rad[0], c.sigma_tilt_rad[1], c.sigma_offset_m}}},
      {"pixels", plane.pixels},
      {"rms_m", plane.rms_m},
      {"margin", plane.margin},
      {"undecided", plane.undecided},
      {"outline", outline_bits(plane.outline)}};
}
ObservedPlane plane_of_bits(const Json& json) {
  ObservedPlane plane;
  plane.label = static_cast<Label>(std::clamp(json.at("label").get<int>(), 0, 255));
  plane.minor = json.at("minor").get<bool>();
  plane.normal = vector_of_bits(json.at("normal"));
  plane.centroid = vector_of_bits(json.at("centroid"));
  const Json& m = json.at("moments");
  const auto moment = [&](std::size_t i) { return m.at(i).get<double>(); };
  plane.moments = {moment(0), {moment(1), moment(2), moment(3)},
                   moment(4), moment(5),
                   moment(6), moment(7),
                   moment(8), moment(9)};
  const Json& c = json.at("certainty");
  plane.certainty.eigenvalues_m2 = vector_of_bits(c.at(0));
  plane.certainty.axes[0] = vector_of_bits(c.at(1));
  plane.certainty.axes[1] = vector_of_bits(c.at(2));
  plane.certainty.sigma_m = c.at(3).at(0).get<double>();
  plane.certainty.sigma_tilt_rad[0] = c.at(3).at(1).get<double>();
  plane.certainty.sigma_tilt_rad[1] = c.at(3).at(2).get<double>();
  plane.certainty.sigma_offset_m = c.at(3).at(3).get<double>();
  plane.pixels = json.at("pixels").get<std::uint32_t>();
  plane.rms_m = json.at("rms_m").get<double>();
  plane.margin = json.at("margin").get<double>();
  plane.undecided = json.at("undecided").get<bool>();
  plane.outline = outline_of_bits(json.at("outline"));
  return plane;
}

/// Value, count, value, count ...
Json runs_json(const Image16& image) {
  Json runs = Json::array();
  for (std::size_t i = 0; i < image.data.size();) {
    std::size_t end = i + 1;
    while (end < image.data.size() && image.data[end] == image.data[i]) ++end;
    runs.push_back(image.data[i]);
    runs.push_back(end - i);
    i = end;
  }
  return runs;
}
/// Throws std::out_of_range where they do not fill the image, or name a plane that is not there.
Image16 image_of(const Json& json, int width, int height, std::size_t planes) {
  Image16 image(width, height);
  std::size_t at = 0;
  const Json& runs = json.at("plane_of");
  for (std::size_t i = 0; i + 1 < runs.size(); i += 2) {
    const auto count = runs[i + 1].get<std::size_t>();
    const auto id = runs[i].get<std::size_t>();
    if (count > image.data.size() - at || id > planes) throw std::out_of_range("a run of pixels");
    std::fill_n(image.data.begin() + static_cast<std::ptrdiff_t>(at), count,
                static_cast<std::uint16_t>(id));
    at += count;
  }
  if (at != image.data.size()) throw std::out_of_range("all pixels");
  return image;
}

}  // namespace

PlanesFrom planes_from(const planes::PipelineOptions& options,
                       const io::RecordingInfo& recording,
                       const UprightPoses& upright) {
  std::string text = tum_text(upright.poses);
  for (const SharedGravity& gravity : upright.gravity)
    text += Json{gravity.known, vector_bits(gravity.direction)}.dump();
  PlanesFrom from = planes_from(options, recording);
  from["poses"] = fmt::format("{}, SHA-256 {:.8}", counted(upright.poses.poses.size(), "pose"),
                              sha256_hex(text));
  return from;
}

std::vector<unsigned char> observed_bytes(const ObservedFrame& frame, const PlanesFrom& from) {
  Json planes = Json::array();
  for (const ObservedPlane& plane : frame.planes) planes.push_back(plane_bits(plane));
  const planes::NoiseModel& noise = frame.noise;
  std::vector<unsigned char> bytes = Json::to_cbor(
      {{"schema", kSchema},
       {"from", from},
       {"frame", frame.frame},
       {"noise", {noise.estimated, noise.by_range, noise.constant_m, noise.growth_per_m}},
       {"planes", std::move(planes)},
       {"size", {frame.plane_of.width, frame.plane_of.height}},
       {"plane_of", runs_json(frame.plane_of)}});
  const std::string check = sha256_hex(std::as_bytes(std::span(bytes)));
  bytes.insert(bytes.end(), check.begin(), check.end());
  return bytes;
}

ObservedFrame read_observed(const std::filesystem::path& file, const PlanesFrom& expected) {
  constexpr int kMostSide = 65536;
  constexpr std::size_t kCheck = 64;
  std::vector<unsigned char> bytes = read_file_bytes(file);
  try {
    if (bytes.size() < kCheck) throw std::out_of_range("the check");
    const auto check = bytes.end() - kCheck;
    if (!std::ranges::equal(sha256_hex(std::as_bytes(std::span(bytes.begin(), check))),
                            std::span(check, bytes.end())))
      throw std::out_of_range("the check");
    bytes.erase(check, bytes.end());
    const Json json = Json::from_cbor(bytes);
    if (json.at("schema") != kSchema) throw std::out_of_range("the schema");
    if (const std::string other = difference(json.at("from").get<PlanesFrom>(), expected);
        !other.empty())
      throw Error(file.string() + ": was made with other options: " + other);
    ObservedFrame frame;
    frame.frame = json.at("frame").get<int>();
    const Json& noise = json.at("noise");
    frame.noise.estimated = noise.at(0).get<bool>();
    frame.noise.by_range = noise.at(1).get<bool>();
    frame.noise.constant_m = noise.at(2).get<double>();
    frame.noise.growth_per_m = noise.at(3).get<double>();
    for (const Json& plane : json.at("planes")) {
      frame.planes.push_back(plane_of_bits(plane));
      frame.planes.back().id = static_cast<int>(frame.planes.size());
    }
    const int width = json.at("size").at(0).get<int>(), height = json.at("size").at(1).get<int>();
    if (width < 1 || height < 1 || width > kMostSide || height > kMostSide)
      throw std::out_of_range("a size");
    frame.plane_of = image_of(json, width, height, frame.planes.size());
    return frame;
  } catch (const std::exception& error) {
    if (dynamic_cast<const Error*>(&error)) throw;
    throw Error(file.string() + ": is damaged or of another version; run its shard again");
  }
}

}  // namespace planescope::world
