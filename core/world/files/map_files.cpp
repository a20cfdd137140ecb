// Writes the map and track files of a recording, and reads maps.

#include "core/world/files/map_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"

namespace planescope::world {

// ---- Writing ----

namespace {

using Json = nlohmann::ordered_json;

/// Rounds to a hundredth of a millimeter, below the accuracy of all values; never minus zero.
double rounded(double value) { return std::round(value * 1e5) / 1e5 + 0.0; }

Json number(double value) { return std::isfinite(value) ? Json(rounded(value)) : Json(nullptr); }

Json vector(const Vec3d& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

Json ring_json(const planes::Outline& outline, const planes::PolygonRing& ring) {
  Json json = Json::array();
  for (const Vec2d& p : ring) json.push_back(vector(outline.world(p)));
  return json;
}

Json outline_json(const planes::Outline& outline) {
  Json parts = Json::array();
  for (const planes::Outline::Part& part : outline.parts) {
    Json holes = Json::array();
    for (const auto& hole : part.holes) holes.push_back(ring_json(outline, hole));
    for (const auto& hole : part.unknown) holes.push_back(ring_json(outline, hole));
    parts.push_back({{"outer", ring_json(outline, part.outer)}, {"holes", std::move(holes)}});
  }
  return parts;
}

Json frames_json(const Track& track) {
  return {{"first", track.born},
          {"last", track.sightings.back().frame},
          {"seen", track.frames_seen},
          {"missed", track.frames_missed},
          {"undecided", track.frames_undecided()}};
}

Json plane_json(const Track& track) {
  const planes::Outline outline = outline_of(track);
  Json json;
  json["track"] = track.id;
  json["label"] = to_string(track.label);
  json["segment"] = track.segment;
  json["state"] = to_string(track.state);
  if (track.state == TrackState::gone) json["gone_at"] = track.ended;
  if (track.left_m2 > 0) json["left_m2"] = rounded(track.left_m2);
  json["normal"] = vector(track.fit.normal);
  json["centroid"] = vector(track.centroid());
  json["offset_m"] = rounded(track.fit.normal.dot(track.centroid()));
  json["sigma_offset_m"] = rounded(track.sigma_m(track.on_grid(track.centroid())));
  json["sigma_tilt_deg"] = rounded(track.sigma_tilt_deg());
  json["rms_m"] = rounded(track.fit.rms_m());
  json["area_m2"] = rounded(outline.area_m2);
  json["frames"] = frames_json(track);
  json["outline"] = outline_json(outline);
  return json;
}

Json stability_json(const Stability& s) {
  return {{"frames", s.frames},
          {"kept_share", number(s.kept_share)},
          {"breaks_per_100_frames", number(s.breaks)},
          {"swaps_per_100_frames", number(s.swaps)},
          {"still_pairs", s.still_pairs},
          {"normal_jitter_deg", number(s.normal_jitter_deg)},
          {"offset_jitter_m", number(s.offset_jitter_m)},
          {"returns", s.returns},
          {"drift_m", number(s.drift_m)}};
}

Json gap_json(const Gap& gap) {
  Json json = {{"first", gap.first}, {"last", gap.last}, {"why", to_string(gap.why)}};
  if (gap.plane > 0) json["plane"] = gap.plane;
  if (gap.term.failed == Term::none) return json;
  json["term"] = to_string(gap.term.failed);
  if (gap.term.failed == Term::taken) {
    json["track"] = static_cast<int>(gap.term.value);
  } else {
    json["value"] = rounded(gap.term.value);
    json["op"] = ">";
    json["threshold"] = rounded(gap.term.threshold);
  }
  return json;
}

/// Frames in which the track was seen, as the first and last frame of each uninterrupted run.
Json seen_json(const Track& track, const Tracker& tracker) {
  Json runs = Json::array();
  const auto& frames = tracker.frames();
  std::size_t at = 0;
  int last = -1;
  for (const Sighting& sighting : track.sightings) {
    if (sighting.part) continue;
    while (at < frames.size() && frames[at].frame != sighting.frame) ++at;
    const bool goes_on = !runs.empty() && at > 0 && frames[at - 1].frame == last;
    if (goes_on)
      runs.back()[1] = sighting.frame;
    else
      runs.push_back({sighting.frame, sighting.frame});
    last = sighting.frame;
  }
  return runs;
}

}  // namespace

std::vector<const Track*> planes_of_map(const Tracker& tracker) {
  struct Sized {
    const Track* track;
    double area_m2;
  };
  std::vector<Sized> sized;
  for (const Track& track : tracker.tracks())
    if (track.is_sure(tracker.options())) sized.push_back({&track, track.sure_area_m2()});
  std::ranges::stable_sort(sized, [](const Sized& a, const Sized& b) {
    const bool a_gone = a.track->state == TrackState::gone,
               b_gone = b.track->state == TrackState::gone;
    return a_gone != b_gone ? b_gone : a.area_m2 > b.area_m2;
  });
  std::vector<const Track*> planes;
  for (const Sized& s : sized) planes.push_back(s.track);
  return planes;
}

namespace {

std::string tracks_json(const WorldMap& map, const std::string& recording) {
  const Tracker& tracker = map.tracker;
  Json json;
  json["schema"] = "planescope.tracks/4";
  json["recording"] = recording;
  json["frames"] = Json::array();
  for (const FrameOfTracks& frame : tracker.frames()) {
    Json entry = {
        {"frame", frame.frame}, {"timestamp_s", frame.timestamp_s}, {"segment", frame.segment}};
    if (!frame.has_pose) entry["without_pose"] = true;
    if (frame.set_aside) entry["set_aside"] = true;
    entry["agreement"] = rounded(frame.agreement);
    if (const auto& down = frame.gravity) entry["gravity"] = {down->x(), down->y(), down->z()};
    std::vector<int> ids;
    for (const int id : frame.track_of) ids.push_back(final_track(tracker.tracks(), id));
    entry["track_of_plane"] = std::vector(ids.begin(), ids.begin() + frame.listed);
    if (frame.listed < std::ssize(ids))
      entry["track_of_minor"] = std::vector(ids.begin() + frame.listed, ids.end());
    if (const auto stored = map.stored.find(frame.frame); stored != map.stored.end()) {
      entry["planes_sha256"] = stored->second.sha256;
      entry["margins"] = Json::array();
      for (const double margin : stored->second.margins)
        entry["margins"].push_back(std::isfinite(margin) ? Json(margin) : Json());
    }
    json["frames"].push_back(std::move(entry));
  }
  json["tracks"] = Json::array();
  for (const Track& track : tracker.tracks()) {
    Json entry = {{"id", track.id},
                  {"label", to_string(track.label)},
                  {"segment", track.segment},
                  {"state", to_string(track.state)},
                  {"born", track.born}};
    if (track.ended >= 0) entry["ended"] = track.ended;
    if (track.merged_into > 0) entry["merged_into"] = track.merged_into;
    if (track.state != TrackState::merged) {
      entry["in_map"] = track.is_sure(tracker.options());
      entry["frames_seen"] = track.frames_seen;
      entry["frames_missed"] = track.frames_missed;
      entry["frames_undecided"] = track.frames_undecided();
      entry["seen"] = seen_json(track, tracker);
      entry["gaps"] = Json::array();
      for (const Gap& gap : track.gaps) entry["gaps"].push_back(gap_json(gap));
    }
    json["tracks"].push_back(std::move(entry));
  }
  return json_text(json);
}

std::string map_json(const WorldMap& map, const std::string& recording, const MapTexts& others) {
  Json json;
  json["schema"] = "planescope.map/4";
  json["recording"] = recording;
  json["pipeline"] = map.planes_from;
  json["files"] = {{"tracks.json", sha256_hex(others.tracks_json)},
                   {"poses.tum", sha256_hex(others.poses_tum)}};
  json["poses"] = {{"source", map.poses.source}, {"count", map.poses.poses.size()}};
  json["gravity"] = Json::array();
  for (std::size_t i = 0; i < map.gravity.size(); ++i) {
    const SharedGravity& g = map.gravity[i];
    json["gravity"].push_back({{"segment", i},
                               {"source", to_string(g.source)},
                               {"spread_deg", rounded(g.spread_deg)},
                               {"frames", g.samples},
                               {"strays", g.strays}});
  }
  const TrackOptions& o = map.tracker.options();
  json["options"] = {{"cell_m", o.cell_m},
                     {"max_offset_m", o.max_offset_m},
                     {"sigmas", o.sigmas},
                     {"least_overlap", o.least_overlap},
                     {"join_gap_m", o.join_gap_m},
                     {"confirm_frames", o.confirm_frames},
                     {"confirm_share", o.confirm_share},
                     {"least_area_m2", o.least_area_m2},
                     {"window_m", o.window_m}};
  json["stability"] = stability_json(map.stability);
  json["told"] = map.warnings;
  json["planes"] = Json::array();
  for (const Track* track : planes_of_map(map.tracker))
    json["planes"].push_back(plane_json(*track));
  return json_text(json);
}

}  // namespace

MapTexts map_texts(const WorldMap& map, const std::string& recording) {
  MapTexts texts;
  texts.poses_tum = tum_text(map.poses);
  texts.tracks_json = tracks_json(map, recording);
  texts.map_json = map_json(map, recording, texts);
  return texts;
}

std::string left_json(const LeftPiece& piece) {
  const Json json = {{"track", piece.track},
                     {"frame", piece.frame},
                     {"area_m2", rounded(piece.outline.area_m2)},
                     {"outline", outline_json(piece.outline)}};
  return json_text(json, -1);
}

std::string pace_json(const Pace& pace) {
  return json_text({{"schema", "planescope.pace/1"},
                    {"frames", pace.frames},
                    {"taken", pace.taken},
                    {"rate_hz", number(pace.rate_hz)},
                    {"behind_ms_median", number(1000 * pace.behind_s_median)},
                    {"behind_ms_most", number(1000 * pace.behind_s_most)}});
}

std::string stability_text(const Stability& s) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (std::isfinite(s.kept_share))
    add(fmt::format("{:.1f} % of pixels on planes continue in the next frame", 100 * s.kept_share));
  if (std::isfinite(s.breaks))
    add(fmt::format("{:.1f} breaks and {:.1f} swaps per 100 frames", s.breaks, s.swaps));
  if (s.still_pairs > 0)
    add(fmt::format(
        "while the camera is still, normals jitter by {:.2f} deg and offsets by {:.1f} mm",
        s.normal_jitter_deg, 1000 * s.offset_jitter_m));
  if (s.returns > 0)
    add(fmt::format("{} returned {:.1f} mm off", counted(s.returns, "plane"), 1000 * s.drift_m));
  return text;
}

// ---- Reading ----

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;

/// Reads a file of a map. Errors name the file.
void read(const fs::path& file,
          const char* schema,
          const std::function<void(const JsonPlace&)>& take) {
  if (!fs::exists(file))
    throw Error(file.string() + ": no such file; expected a folder written by planescope map");
  read_place(file, read_json<Json>(file, kMostBytes), [&](const JsonPlace& place) {
    try {
      place.schema({schema});
    } catch (const Error& error) {
      throw Error(error.what() + std::string("; rebuild the map"));
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
    throw Error(fmt::format("belongs to recording {}; expected {}", shown(found), shown(name)));
  PlanesFrom from;
  for (const auto& item : place.at("pipeline").json().items())
    from[item.key()] = place.at("pipeline").at(item.key().c_str()).text();
  if (const std::string other = difference(from, planes_from(options, recording)); !other.empty())
    throw Error("created with different options: " + other);
  FieldReader fields(place);
  fields.list("gravity", map.gravity, kPlain, [](auto& of, SharedGravity& shared) {
    of("source", shared.source);
    shared.known = shared.source != GravitySource::none;
    of("spread_deg", shared.spread_deg);
    of("frames", shared.samples, kSigned);
    of("strays", shared.strays, kSigned);
  });
}

void read_frame_fields(FieldReader& fields, KnownMap& map) {
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
    throw Error(fmt::format("frame {} has {} for {}; expected one per plane", frame,
                            counted(planes.margins.size(), "margin"),
                            counted(planes.tracks.size(), "plane")));
}

std::shared_ptr<const GivenPlanes> given_planes(const KnownMap& map, int frame) {
  const auto at = map.planes_of.find(frame);
  if (at == map.planes_of.end() || at->second.sha256.empty()) return nullptr;
  const fs::path file = planes_file(map.dir, frame);
  const std::vector<unsigned char> bytes = read_file_bytes(file);
  if (sha256_hex(std::as_bytes(std::span(bytes))) != at->second.sha256)
    throw Error(
        fmt::format("{}: does not match {}", file.string(), (map.dir / "tracks.json").string()));
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
      throw Error(fmt::format("{}: does not match {}", file.string(), (dir / "map.json").string()));
  read(dir / "tracks.json", "planescope.tracks/4", [&](const JsonPlace& place) {
    place.at("frames").each([&](const JsonPlace& frame) {
      FieldReader fields(frame);
      read_frame_fields(fields, *map);
    });
  });
  map->poses = read_trajectory(dir / "poses.tum");
  for (const CameraPose& pose : map->poses.poses) {
    if (pose.frame < 0 || pose.segment < 0 || pose.segment >= std::ssize(map->gravity))
      throw Error((dir / "poses.tum").string() + ": does not match map.json");
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
      frame.gravity->direction = *at->second.gravity;  // the frame was aligned afterwards
    frame.given = given_planes(*map, frame.index);
  });
}

const std::vector<int>& tracks_of(const KnownMap& map, int frame, std::size_t planes) {
  const std::vector<int>& tracks = map.planes_of.at(frame).tracks;
  if (tracks.size() != planes)
    throw Error(fmt::format("frame {}: has {}; expected the {} in {}", frame,
                            counted(planes, "plane"), tracks.size(),
                            (map.dir / "tracks.json").string()));
  return tracks;
}

}  // namespace planescope::world
