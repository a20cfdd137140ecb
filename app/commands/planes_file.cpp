// Writes frames and their planes as ROS 2 messages to an MCAP file.

#include "app/commands/planes_file.hpp"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/palette.hpp"
#include "core/model/text.hpp"
#include "core/report/data/ros_planes.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

constexpr double kRate_hz = 30;  // for recordings without timestamps
constexpr double kMillimeter = 0.001;

/// Frames need distinct times; viewers show messages with equal times as one frame.
std::int64_t stamp_of(double timestamp_s, int frame) {
  return io::ros_stamp(timestamp_s != 0 ? timestamp_s : frame / kRate_hz);
}

/// One map frame per segment, because the motion between segments is unknown.
std::string in_segment(const char* name, int segment) {
  return segment == 0 ? name : fmt::format("{}_{}", name, segment);
}

bool is_within(const fs::path& path, const fs::path& folder) {
  const fs::path inside = fs::weakly_canonical(path).lexically_relative(fs::canonical(folder));
  return !inside.empty() && *inside.begin() != "..";
}

}  // namespace

bool is_planes_file(const fs::path& out) {
  return lower_case(out.extension().string()) == ".mcap" && !fs::is_directory(out);
}

FrameMessages messages_of(const Frame& frame,
                          const planes::FrameResult& result,
                          const planes::FramePlanes& found,
                          const world::KnownMap* map) {
  report::RosPlace place{.stamp_ns = stamp_of(frame.timestamp_s, frame.index), .map = "map"};
  place.T_map_camera = frame.T_world_camera.value_or(result.cloud.T_world_sensor);
  if (map) {
    const world::CameraPose& pose = *pose_of(map->poses, frame.index);
    place.map = in_segment("map", pose.segment);
    place.T_map_camera = pose.T_world_camera;
  }
  FrameMessages messages{place.stamp_ns, {}};
  for (const report::RosTopic& topic : report::ros_topics()) {
    io::RosMessage message = topic.message(frame, result, found, place);
    if (!message.topic.starts_with("/")) message.topic = "/planescope/" + message.topic;
    messages.list.push_back(std::move(message));
  }
  if (frame.is_cloud()) return messages;
  // ROS programs interpret counts as millimeters.
  const auto encoding =
      frame.depth_unit_m == kMillimeter ? io::DepthEncoding::counts : io::DepthEncoding::meters;
  for (io::RosMessage& message : io::ros_camera(frame, place.stamp_ns, encoding))
    messages.list.push_back(std::move(message));
  return messages;
}

std::vector<io::RosMessage> messages_of(const world::WorldMap& map) {
  std::map<int, std::vector<report::RosPose>> ways;  // camera paths, by segment
  for (const world::CameraPose& pose : map.poses.poses)
    ways[pose.segment].push_back({stamp_of(pose.timestamp_s, pose.frame), pose.T_world_camera});
  std::vector<planes::Outline> outlines;
  std::vector<report::MarkedPlane> planes;
  for (const world::Track* track : world::planes_of_map(map.tracker)) {
    if (track->state != world::TrackState::alive) continue;
    outlines.push_back(world::outline_of(*track));
    planes.push_back({track->id, plane_hue(track->id), fmt::format("T{}", track->id),
                      in_segment("map", track->segment), track->fit.normal, track->centroid(),
                      nullptr});
  }
  for (std::size_t i = 0; i < planes.size(); ++i) planes[i].outline = &outlines[i];
  const std::int64_t start_ns = ways.begin()->second.front().stamp_ns;
  std::vector<io::RosMessage> messages = {
      report::ros_map_markers("/planescope/map", start_ns, planes)};
  for (const auto& [segment, way] : ways)
    messages.push_back(
        report::ros_path(in_segment("/planescope/path", segment), in_segment("map", segment), way));
  return messages;
}

PlanesFile::PlanesFile(const fs::path& out, const fs::path& recording)
    : out_(out), output_(out.has_parent_path() ? out.parent_path() : ".") {
  if (fs::exists(out)) throw Error(out.string() + ": already exists; expected a new name");
  if (fs::is_directory(recording) && is_within(out, recording))
    throw Error(fmt::format("{}: is inside the recording {}; expected a different folder",
                            out.string(), recording.string()));
  staged_ = output_.add_file(out.filename());
  file_.open(staged_, std::ios::binary);
  writer_.emplace(file_);
}

fs::path PlanesFile::work_folder() const { return staged_.parent_path() / "map"; }

void PlanesFile::add(const FrameMessages& frame) {
  for (const io::RosMessage& message : std::exchange(first_, {}))
    writer_->add(message, frame.stamp_ns, true);
  for (const io::RosMessage& message : frame.list)
    writer_->add(message, frame.stamp_ns, message.topic == "/tf_static");
  writer_->end_chunk();
  if (!file_) throw Error(out_.string() + ": cannot be written");
}

void PlanesFile::commit() {
  writer_->finish();
  file_.close();
  if (!file_) throw Error(out_.string() + ": cannot be written");
  output_.commit();
}

}  // namespace planescope::app
