#include "core/world/files/known_map.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"

namespace planescope::world {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;

/// A file of a map. Its Errors name it.
void read(const fs::path& file,
          const char* schema,
          const std::function<void(const JsonPlace&)>& take) {
  if (!fs::exists(file))
    throw Error(file.string() + ": is missing, expected a folder that planescope map wrote");
  read_place(file, read_json<Json>(file, kMostBytes), [&](const JsonPlace& place) {
    try {
      place.schema({schema});
    } catch (const Error& error) {
      throw Error(error.what() + std::string(": make the map again"));
    }
    take(place);
  });
}

void take_map(const JsonPlace& place,
              const io::RecordingInfo& recording,
              const planes::PipelineOptions& options,
              KnownMap& map) {
  const std::string name = recording.path.filename().string(), found = place.at("recording").text();
  if (found != name)
    throw Error(fmt::format("is of the recording {}, expected {}", shown(found), shown(name)));
  PlanesFrom from;
  for (const auto& item : place.at("pipeline").json().items())
    from[item.key()] = place.at("pipeline").at(item.key().c_str()).text();
  if (const std::string other = difference(from, planes_from(options, recording)); !other.empty())
    throw Error("its planes were found with other options: " + other);
  FieldReader fields(place);
  fields.list("gravity", map.gravity, kPlain, [](auto& of, SharedGravity& shared) {
    of("source", shared.source);
    shared.known = shared.source != GravitySource::none;
    of("spread_deg", shared.spread_deg);
    of("frames", shared.samples, kSigned);
    of("strays", shared.strays, kSigned);
  });
}

void take_frame(FieldReader& fields, KnownMap& map) {
  int frame = 0;
  fields("frame", frame);
  KnownMap::FramePlanes& planes = map.planes_of[frame];
  fields("track_of_plane", planes.tracks);
  fields("gravity", planes.gravity, kOptional);
  fields("planes_sha256", planes.sha256, kOptional);
  if (planes.sha256.empty()) return;
  std::vector<std::optional<double>> margins;
  fields("margins", margins);
  for (const auto& margin : margins)
    planes.margins.push_back(margin.value_or(std::numeric_limits<double>::infinity()));
  if (planes.margins.size() < planes.tracks.size())
    throw Error(fmt::format("frame {} has {} for {}", frame,
                            counted(planes.margins.size(), "margin"),
                            counted(planes.tracks.size(), "plane")));
}

std::shared_ptr<const GivenPlanes> given_planes(const KnownMap& map, int frame) {
  const auto at = map.planes_of.find(frame);
  if (at == map.planes_of.end() || at->second.sha256.empty()) return nullptr;
  const fs::path file = planes_file(map.dir, frame);
  const std::vector<unsigned char> bytes = read_file_bytes(file);
  if (sha256_hex(std::as_bytes(std::span(bytes))) != at->second.sha256)
    throw Error(fmt::format("{}: is not what {} was written with", file.string(),
                            (map.dir / "tracks.json").string()));
  return std::make_shared<const GivenPlanes>(GivenPlanes{io::decode_png_16(bytes, file.string()),
                                                         static_cast<int>(at->second.tracks.size()),
                                                         at->second.margins});
}

}  // namespace

fs::path planes_file(const fs::path& dir, int frame) {
  return dir / "planes" / fmt::format("{:06}.png", frame);
}

std::shared_ptr<const KnownMap> read_known_map(const fs::path& dir,
                                               const io::RecordingInfo& recording,
                                               const planes::PipelineOptions& options) {
  const auto map = std::make_shared<KnownMap>();
  map->dir = dir;
  std::map<std::string, std::string> hashes;
  read(dir / "map.json", "planescope.map/4", [&](const JsonPlace& place) {
    take_map(place, recording, options, *map);
    for (const char* name : {"tracks.json", "poses.tum"})
      hashes[name] = place.at("files").at(name).text();
  });
  for (const auto& [name, hash] : hashes)
    if (const fs::path file = dir / name; sha256_hex_of_file(file) != hash)
      throw Error(fmt::format("{}: is not what {} was written with", file.string(),
                              (dir / "map.json").string()));
  read(dir / "tracks.json", "planescope.tracks/4", [&](const JsonPlace& place) {
    place.at("frames").each([&](const JsonPlace& frame) {
      FieldReader fields(frame);
      take_frame(fields, *map);
    });
  });
  map->poses = read_trajectory(dir / "poses.tum");
  for (const CameraPose& pose : map->poses.poses) {
    if (pose.frame < 0 || pose.segment < 0 || pose.segment >= std::ssize(map->gravity))
      throw Error((dir / "poses.tum").string() + ": does not go with map.json");
  }
  return map;
}

std::shared_ptr<const io::Recording> with_map(std::shared_ptr<const io::Recording> recording,
                                              std::shared_ptr<const KnownMap> map) {
  return io::with_changed_frames(std::move(recording), [map = std::move(map)](Frame& frame) {
    if (const CameraPose* pose = pose_of(map->poses, frame.index))
      turn_to_map(frame, {}, *pose, *map);
    if (const auto at = map->planes_of.find(frame.index);
        at != map->planes_of.end() && at->second.gravity)
      frame.gravity->direction = *at->second.gravity;  // the frame was aligned after that
    frame.given = given_planes(*map, frame.index);
  });
}

const std::vector<int>& tracks_of(const KnownMap& map, int frame, std::size_t planes) {
  const std::vector<int>& tracks = map.planes_of.at(frame).tracks;
  if (tracks.size() != planes)
    throw Error(fmt::format("frame {}: has {}, expected the {} of {}", frame,
                            counted(planes, "plane"), tracks.size(),
                            (map.dir / "tracks.json").string()));
  return tracks;
}

}  // namespace planescope::world
