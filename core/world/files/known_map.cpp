#include "core/world/files/known_map.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/sha256.hpp"
#include "core/model/text.hpp"

namespace planescope::world {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;

Json read(const fs::path& file, const std::string& schema) {
  if (!fs::exists(file))
    throw Error(file.string() + ": is missing, expected a folder that planescope map wrote");
  Json json = read_json<Json>(file, kMostBytes);
  const Json found = json.is_object() ? json.value("schema", Json()) : Json();
  if (found != schema)
    throw Error(fmt::format("{}: has the schema {}, expected \"{}\": make the map again",
                            file.string(), found.dump(), schema));
  return json;
}

GravitySource source_of(const std::string& name) {
  for (int i = 0; i <= static_cast<int>(kLastGravitySource); ++i)
    if (to_string(static_cast<GravitySource>(i)) == name) return static_cast<GravitySource>(i);
  throw Error("no gravity comes from " + shown(name));
}

void take_map(const Json& json,
              const io::RecordingInfo& recording,
              const planes::PipelineOptions& options,
              KnownMap& map) {
  const std::string name = recording.path.filename().string();
  if (json.at("recording") != name)
    throw Error(fmt::format("is of the recording {}, expected {}", json.at("recording").dump(),
                            shown(name)));
  const PlanesFrom found = json.at("pipeline").get<PlanesFrom>();
  if (const std::string other = difference(found, planes_from(options, recording)); !other.empty())
    throw Error("its planes were found with other options: " + other);
  for (const Json& gravity : json.at("gravity")) {
    SharedGravity& shared = map.gravity.emplace_back();
    shared.source = source_of(gravity.at("source").get<std::string>());
    shared.known = shared.source != GravitySource::none;
    shared.spread_deg = gravity.at("spread_deg").get<double>();
    shared.samples = whole_int(gravity.at("frames"), "frames");
    shared.strays = whole_int(gravity.at("strays"), "strays");
  }
}

void take_tracks(const Json& json, KnownMap& map) {
  for (const Json& frame : json.at("frames")) {
    const auto number = [](const Json& value, const char* what) {
      return static_cast<int>(whole_number(value, 0, std::numeric_limits<int>::max(), what));
    };
    KnownMap::FramePlanes& planes = map.planes_of[number(frame.at("frame"), "a frame")];
    for (const Json& track : frame.at("track_of_plane"))
      planes.tracks.push_back(number(track, "a track"));
    if (const auto down = frame.find("gravity"); down != frame.end())
      planes.gravity = {down->at(0).get<double>(), down->at(1).get<double>(),
                        down->at(2).get<double>()};
    if (!frame.contains("planes_sha256")) continue;
    planes.sha256 = frame.at("planes_sha256").get<std::string>();
    for (const Json& margin : frame.at("margins"))
      planes.margins.push_back(margin.is_null() ? std::numeric_limits<double>::infinity()
                                                : margin.get<double>());
    if (planes.margins.size() < planes.tracks.size())
      throw Error(fmt::format("frame {} has {} for {}", frame.at("frame").dump(),
                              counted(planes.margins.size(), "margin"),
                              counted(planes.tracks.size(), "plane")));
  }
}

/// Names the file in what goes wrong.
template <typename Take>
void reading(const fs::path& file, const Take& how) {
  try {
    how();
  } catch (const Json::exception& problem) {
    throw Error(fmt::format("{}: {}, expected what planescope map wrote", file.string(),
                            json_problem(problem)));
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
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
  const Json told = read(dir / "map.json", "planescope.map/4");
  reading(dir / "map.json", [&] { take_map(told, recording, options, *map); });
  for (const char* name : {"tracks.json", "poses.tum"})
    if (const fs::path file = dir / name; sha256_hex_of_file(file) != told.at("files").at(name))
      throw Error(fmt::format("{}: is not what {} was written with", file.string(),
                              (dir / "map.json").string()));
  const Json tracks = read(dir / "tracks.json", "planescope.tracks/4");
  reading(dir / "tracks.json", [&] { take_tracks(tracks, *map); });
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
