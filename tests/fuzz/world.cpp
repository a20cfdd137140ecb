// Maps and what is read to build them: poses, map files, and frames of shards.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "core/io/image/png.hpp"
#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/world/files/map_files.hpp"
#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {
namespace {

namespace fs = std::filesystem;

void read_poses(Bytes bytes) {
  const world::Trajectory read = world::read_trajectory(file_of("poses/a.txt", bytes));
  const std::string text = world::tum_text(read);
  const auto again =
      world::read_trajectory(file_of("poses/again.txt", ByteVector(text.begin(), text.end())));
  require(again.poses.size() == read.poses.size(), "poses that are lost when written and read");
}

planes::PipelineOptions map_options() {
  planes::PipelineOptions options;
  options.gravity.none_where_unknown = true;
  return options;
}

std::shared_ptr<const io::Recording> two_frames() {
  static const std::shared_ptr<const io::Recording> recording = [] {
    for (const char* name : {"000000", "000001"})
      file_of(std::string("world/depth/") + name + ".png", io::encode_png(plain_depth()));
    io::RecordingOptions options;
    options.intrinsics = {30, 30, 12, 8};
    return io::open_recording(memory_folder() / "world", options);
  }();
  return recording;
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at != std::string::npos) text.replace(at, from.size(), to);
}

/// map.json, tracks.json and poses.tum with zeros between. Words in capitals stand for the hashes
/// and options that a map must have to be read.
void read_map(Bytes bytes) {
  const std::string all = text_of(bytes);
  const std::size_t first = std::min(all.find('\0'), all.size()),
                    second = std::min(all.find('\0', first + 1), all.size());
  std::string map = all.substr(0, first);
  std::string tracks = first < all.size() ? all.substr(first + 1, second - first - 1) : "";
  const std::string poses = second < all.size() ? all.substr(second + 1) : "";
  static const ByteVector planes = io::encode_png(Image16(24, 16, 1, 1));
  replace(tracks, "PLANES", sha256_hex(std::as_bytes(std::span(planes))));
  const auto recording = two_frames();
  const planes::PipelineOptions options = map_options();
  replace(map, "PIPELINE", nlohmann::json(world::planes_from(options, recording->info())).dump());
  replace(map, "TRACKS", sha256_hex(tracks));
  replace(map, "POSES", sha256_hex(poses));
  const auto write = [](const std::string& name, const std::string& text) {
    return file_of("map/" + name, ByteVector(text.begin(), text.end())).parent_path();
  };
  write("planes/000000.png", std::string(planes.begin(), planes.end()));
  write("tracks.json", tracks);
  write("poses.tum", poses);
  const auto known = world::read_known_map(write("map.json", map), recording->info(), options);
  const auto with_map = world::with_map(recording, known);
  static const auto classifier = planes::make_pca_classifier();
  for (int i = 0; i < recording->frame_count(); ++i) {
    if (!known->knows(i)) continue;
    try {
      const planes::FrameResult result =
          planes::run_frame(with_map->frame(i), world::options_of_map(options), classifier.get());
      world::tracks_of(*known, i, result.segmentation.planes.size());
    } catch (const Error&) {
      // The other frame may be whole.
    }
  }
}

/// CBOR, whose check is added.
void read_observed(Bytes bytes) {
  const std::string check = sha256_hex(std::as_bytes(bytes));
  ByteVector file(bytes.begin(), bytes.end());
  file.insert(file.end(), check.begin(), check.end());
  world::read_observed(file_of("observed/000000.cbor", file), {{"method", "ours"}});
}

}  // namespace

std::vector<Target> world_targets() {
  return {{"poses", read_poses}, {"map", read_map}, {"observed", read_observed}};
}

}  // namespace planescope::fuzz
