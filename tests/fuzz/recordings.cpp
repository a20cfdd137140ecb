// Fuzz targets for core/io: recordings, their images, and the files beside them.

#include <fcntl.h>

#include <algorithm>
#include <cmath>

#include "core/io/bag/message_log.hpp"
#include "core/io/bag/ros_messages.hpp"
#include "core/io/byte_reader.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/folder/folder_files.hpp"
#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {
namespace {

namespace fs = std::filesystem;

/// Reads everything that programs read from a recording.
void read_frames(const io::Recording& recording) {
  require(recording.frame_count() > 0, "a recording without frames");
  for (int i = 0; i < std::min(recording.frame_count(), 4); ++i) try {
      const Frame frame = recording.frame(i);
      const bool is_image =
          frame.depth.data.size() == frame.depth.pixels() && frame.intrinsics.fx > 0;
      require(frame.is_cloud() || is_image, "a frame that is neither image nor cloud");
      require(frame.is_cloud() || frame.depth_unit_m > 0, "a frame without a unit");
      if (frame.gravity)
        require(std::abs(frame.gravity->direction.norm() - 1) < 1e-6, "gravity of another length");
      recording.frame_hash(i);
      recording.timestamp_s(i);
    } catch (const Error&) {
      // Other frames may be intact.
    }
}

void read_bag(Bytes bytes) { read_frames(*io::open_recording(file_of("bag/a.bag", bytes))); }

void read_db3(Bytes bytes) { read_frames(*io::open_recording(file_of("db3/a.db3", bytes))); }
void read_mcap(Bytes bytes) { read_frames(*io::open_recording(file_of("mcap/a.mcap", bytes))); }

/// The bytes behind the header of a `compressedDepth` message of ROS 1. Images of many pixels are
/// only slower, up to the read limit.
void read_rvl(Bytes bytes) {
  constexpr std::size_t kSides = 12;  // after the configuration
  if (bytes.size() >= kSides + 8) {
    io::ByteReader sides(std::as_bytes(bytes.subspan(kSides)));
    const std::uint64_t width = sides.read<std::uint32_t>(), height = sides.read<std::uint32_t>();
    if (width < (1 << 15) && height < (1 << 15) && width * height > (1 << 20)) return;
  }
  ByteVector message;
  const auto put = [&](std::uint32_t number) {
    for (int shift = 0; shift < 32; shift += 8)
      message.push_back(static_cast<unsigned char>(number >> shift));
  };
  const auto put_bytes = [&](Bytes all) {
    put(static_cast<std::uint32_t>(all.size()));
    message.insert(message.end(), all.begin(), all.end());
  };
  const std::string format = "16UC1; compressedDepth rvl";
  for (int i = 0; i < 3; ++i) put(0);  // sequence number and time
  put_bytes({});                       // frame id
  put_bytes({reinterpret_cast<const unsigned char*>(format.data()), format.size()});
  put_bytes(bytes);
  try {
    const auto read = io::ros::read_image({{}, std::as_bytes(std::span(message)), io::Wire::ros1},
                                          "sensor_msgs/CompressedImage", "a");
    require(read.image.data.size() == read.image.step * static_cast<std::size_t>(read.image.height),
            "an image of other bytes");
  } catch (const io::OutOfBytes&) {
    // Readers of recordings add the place.
  }
}

void read_png(Bytes bytes) {
  const fs::path path = file_of("png/a.png", bytes);
  for (const auto reader : {+[](const fs::path& p) { io::read_png_16(p); },
                            +[](const fs::path& p) { io::read_png_grey(p); },
                            +[](const fs::path& p) { io::read_png_rgb(p); },
                            +[](const fs::path& p) { io::png_is_cut(p); }})
    try {
      reader(path);
    } catch (const Error&) {
      // Other readers read other kinds.
    }
  io::RecordingOptions options;
  options.intrinsics = {10, 10, 5, 5};
  read_frames(*io::open_recording(path, options));
}

void read_jpeg(Bytes bytes) {
  const Image8 image = io::read_jpeg_rgb(file_of("jpeg/a.jpg", bytes));
  require(image.data.size() == 3 * image.pixels(), "a JPEG that is no RGB image");
}

void read_cloud(const std::string& name, Bytes bytes) {
  const fs::path path = file_of(name, bytes);
  io::CloudExtras extras{{"u", "intensity"}, {}};
  const PointSet set = io::read_cloud_file(path, &extras);
  for (const std::vector<double>& values : extras.values)
    require(values.empty() || values.size() == set.points.size(), "a field of another length");
  require(set.rgb.empty() || set.rgb.size() == 3 * set.points.size(), "colours of other points");
  require(set.label.empty() || set.label.size() == set.points.size(), "labels of other points");
  io::RecordingOptions options;
  read_frames(*io::open_recording(path, options));
  options.instance_field = "intensity";
  read_frames(*io::open_recording(path, options));
}

void read_ply(Bytes bytes) { read_cloud("ply/a.ply", bytes); }
void read_pcd(Bytes bytes) { read_cloud("pcd/a.pcd", bytes); }

/// The input is the metadata; the counts beside it are zeros.
void read_viewer_raw(Bytes bytes) {
  file_of("viewer_raw/a.raw", ByteVector(2 * 24 * 16));
  read_frames(*io::open_recording(file_of("viewer_raw/a_metadata.csv", bytes)));
}

void read_stream(Bytes bytes) {
  const FileDescriptor file = open_file(file_of("stream/a", bytes), O_RDONLY);
  const auto stream = io::open_stream(file.get(), {}, false);
  while (stream->wait_for_frame({}))
    require(stream->frame(stream->frame_count() - 1).depth.pixels() > 0, "a frame without pixels");
}

void read_camera_json(Bytes bytes) {
  io::camera_from_json(file_of("camera/intrinsic.json", bytes));
}
void read_camera_xml(Bytes bytes) { io::camera_from_opencv_xml(file_of("camera/a.xml", bytes)); }
void read_camera_text(Bytes bytes) { io::camera_from_text(file_of("camera/a.txt", bytes)); }

/// The input is a sidecar beside one depth image, for its camera.
void read_sidecar(Bytes bytes) {
  static const ByteVector image = io::encode_png(plain_depth());
  file_of("sidecar/depth/000000.png", image);
  read_frames(*io::open_recording(file_of("sidecar/planescope.json", bytes).parent_path()));
}

void read_gravity(Bytes bytes) {
  static const std::unique_ptr<io::Recording> recording = [] {
    file_of("recording/depth/000000.png", io::encode_png(plain_depth()));
    io::RecordingOptions options;
    options.intrinsics = {10, 10, 5, 5};
    return io::open_recording(memory_folder() / "recording", options);
  }();
  const fs::path dir = file_of("gravity/gravity.json", bytes).parent_path();
  const io::PickedGravity picked = io::read_picked_gravity(dir, *recording);
  io::write_picked_gravity(dir, picked);
  if (!picked.empty()) io::read_picked_gravity(dir, *recording);
}

}  // namespace

std::vector<Target> recording_targets() {
  return {{"bag", read_bag},
          {"db3", read_db3},
          {"mcap", read_mcap},
          {"rvl", read_rvl},
          {"png", read_png},
          {"jpeg", read_jpeg},
          {"ply", read_ply},
          {"pcd", read_pcd},
          {"viewer_raw", read_viewer_raw},
          {"stream", read_stream},
          {"camera_json", read_camera_json},
          {"camera_xml", read_camera_xml},
          {"camera_text", read_camera_text},
          {"sidecar", read_sidecar},
          {"gravity", read_gravity}};
}

}  // namespace planescope::fuzz
