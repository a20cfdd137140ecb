// Files with the observed planes of one frame, exchanged between the shards of a map.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::world {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.observed/5";

/// Stops at documents nested so deeply that reading them would overflow the stack.
struct DepthCheck : nlohmann::detail::json_sax_acceptor<Json> {
  bool start_object(std::size_t) { return ++depth <= kDeepestJson; }
  bool start_array(std::size_t) { return ++depth <= kDeepestJson; }
  bool end_object() { return --depth >= 0; }
  bool end_array() { return --depth >= 0; }
  int depth = 0;
};

/// Writes values to JSON or reads them from it, with one function per type. Missing values throw
/// Json's own exceptions.
class Exchange {
 public:
  explicit Exchange(bool reads) : reads_(reads) {}

  /// Camera, pose and depth are read elsewhere.
  void operator()(Json& json, ObservedFrame& frame) const {
    fields(json, "frame", frame.frame, "noise", frame.noise, "planes", frame.planes);
  }

 private:
  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void one(Json& json, Number& value) const {
    if (reads_)
      value = json.get<Number>();
    else
      json = value;
  }
  /// Values in sequence.
  template <typename... Values>
  void list(Json& json, Values&... values) const {
    if (!reads_) json = Json::array();
    std::size_t i = 0;
    (one(reads_ ? json.at(i++) : json.emplace_back(), values), ...);
  }
  void fields(Json&) const {}
  /// Alternating names and values.
  template <typename Value, typename... Rest>
  void fields(Json& json, const char* name, Value& value, Rest&&... rest) const {
    one(reads_ ? json.at(name) : json[name], value);
    fields(json, rest...);
  }

  void one(Json& json, Vec3d& v) const { list(json, v.x(), v.y(), v.z()); }
  /// x, y, x, y ...
  void one(Json& json, planes::PolygonRing& ring) const {
    if (!reads_) json = Json::array();
    if (reads_) ring.resize(json.size() / 2);
    for (std::size_t i = 0; i < ring.size(); ++i)
      for (const int k : {0, 1}) one(reads_ ? json.at(2 * i + k) : json.emplace_back(), ring[i][k]);
  }
  template <typename Value>
  void one(Json& json, std::vector<Value>& values) const {
    if (!reads_) json = Json::array();
    if (reads_) values.resize(json.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      one(reads_ ? json.at(i) : json.emplace_back(), values[i]);
  }
  void one(Json& json, planes::Outline::Part& part) const {
    list(json, part.outer, part.holes, part.unknown);
  }
  void one(Json& json, planes::Outline& outline) const {
    fields(json, "origin", outline.origin, "u", outline.basis.u, "v", outline.basis.v, "area_m2",
           outline.area_m2, "parts", outline.parts);
  }
  void one(Json& json, Moments& m) const {
    list(json, m.count, m.sum.x(), m.sum.y(), m.sum.z(), m.xx, m.xy, m.xz, m.yy, m.yz, m.zz);
  }
  void one(Json& json, planes::NoiseModel& noise) const {
    list(json, noise.estimated, noise.by_range, noise.constant_m, noise.growth_per_m);
  }
  struct Sigmas {
    planes::Certainty& of;
  };
  void one(Json& json, Sigmas& sigmas) const {
    planes::Certainty& c = sigmas.of;
    list(json, c.sigma_m, c.sigma_tilt_rad[0], c.sigma_tilt_rad[1], c.sigma_offset_m);
  }
  void one(Json& json, planes::Certainty& c) const {
    Sigmas sigmas{c};
    list(json, c.eigenvalues_m2, c.axes[0], c.axes[1], sigmas);
  }
  void one(Json& json, ObservedPlane& plane) const {
    int label = static_cast<int>(plane.label);
    fields(json, "label", label, "minor", plane.minor, "normal", plane.normal, "centroid",
           plane.centroid, "moments", plane.moments, "certainty", plane.certainty, "pixels",
           plane.pixels, "rms_m", plane.rms_m, "margin", plane.margin, "undecided", plane.undecided,
           "outline", plane.outline);
    plane.label = static_cast<Label>(std::clamp(label, 0, 255));
  }

  bool reads_;
};

/// Run-length encoding: value, count, value, count ...
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
/// Throws std::out_of_range if the runs do not fill the image or refer to a missing plane.
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
    text += Json{gravity.known, Json(std::span(gravity.direction.data(), 3))}.dump();
  PlanesFrom from = planes_from(options, recording);
  from["poses"] = fmt::format("{}, SHA-256 {:.8}", counted(upright.poses.poses.size(), "pose"),
                              sha256_hex(text));
  return from;
}

std::vector<unsigned char> observed_bytes(const ObservedFrame& frame, const PlanesFrom& from) {
  Json json = {{"schema", kSchema}, {"from", from}};
  ObservedFrame same;
  same.frame = frame.frame;
  same.noise = frame.noise;
  same.planes = frame.planes;
  Exchange(false)(json, same);
  json["size"] = {frame.plane_of.width, frame.plane_of.height};
  json["plane_of"] = runs_json(frame.plane_of);
  std::vector<unsigned char> bytes = Json::to_cbor(json);
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
    DepthCheck depth;
    if (!Json::sax_parse(bytes, &depth, Json::input_format_t::cbor))
      throw std::out_of_range("valid CBOR");
    Json json = Json::from_cbor(bytes);
    if (json.at("schema") != kSchema) throw std::out_of_range("the schema");
    if (const std::string other = difference(json.at("from").get<PlanesFrom>(), expected);
        !other.empty())
      throw Error(file.string() + ": created with different options: " + other);
    ObservedFrame frame;
    Exchange(true)(json, frame);
    for (std::size_t i = 0; i < frame.planes.size(); ++i)
      frame.planes[i].id = static_cast<int>(i) + 1;
    const int width = json.at("size").at(0).get<int>(), height = json.at("size").at(1).get<int>();
    if (width < 1 || height < 1 || width > kMostSide || height > kMostSide)
      throw std::out_of_range("a size");
    expect_within_read_limit(2.0 * width * height, file.string() + ": its pixels");
    frame.plane_of = image_of(json, width, height, frame.planes.size());
    return frame;
  } catch (const std::exception& error) {
    if (dynamic_cast<const Error*>(&error)) throw;
    throw Error(file.string() + ": damaged or from a different version; rerun its shard");
  }
}

}  // namespace planescope::world
