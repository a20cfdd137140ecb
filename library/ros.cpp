// Planes from serialized ROS 2 messages, and serialized messages from planes.

#include "planescope/ros.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "core/io/bag/ros_messages.hpp"
#include "core/io/readers.hpp"
#include "core/report/data/ros_planes.hpp"
#include "library/data.hpp"

namespace planescope::v0 {
namespace {

constexpr double kMillimeter_m = 0.001;

/// Reads a message through `parse`.
template <typename Parse>
auto parse(View<std::uint8_t> cdr, const char* type, const Parse& parse) {
  const io::Bytes bytes(reinterpret_cast<const std::byte*>(cdr.data()), cdr.size());
  try {
    return parse(io::Message{nullptr, bytes, io::Wire::cdr});
  } catch (io::OutOfBytes) {
    throw Error(fmt::format("{}: damaged {}-byte message", type, cdr.size()));
  }
}

Intrinsics intrinsics_of(const io::ros::CameraInfo& info) {
  Intrinsics camera{info.width,
                    info.height,
                    info.k(0, 0),
                    info.k(1, 1),
                    info.k(0, 2),
                    info.k(1, 2),
                    ::planescope::Distortion::none,
                    {}};
  if (!io::set_distortion(info.distortion_model, info.d, camera))
    throw Error(
        fmt::format("camera_info: lens distortion \"{}\" is not supported", info.distortion_model));
  if (!(camera.fx > 0 && camera.fy > 0))
    throw Error(
        fmt::format("camera_info: focal length {}, {} px; expected values above 0 in k[0] and k[4]",
                    camera.fx, camera.fy));
  return camera;
}

/// Sets the frame's depth and its unit.
void take_depth(const io::ros::Image& image, ::planescope::Frame& frame) {
  const bool is_float = image.encoding == "32FC1";
  if (!is_float && image.encoding != "16UC1" && image.encoding != "mono16")
    throw Error(fmt::format(
        "image: encoding \"{}\" is not supported; expected depth as 16UC1, mono16, or 32FC1",
        image.encoding));
  const auto width = static_cast<std::size_t>(image.width);
  const std::size_t size = is_float ? 4 : 2;
  if (image.step < size * width)
    throw Error(fmt::format("image: {}-byte rows; expected at least {} bytes for {} pixels",
                            image.step, size * width, width));
  frame.depth_unit_m = kMillimeter_m;
  frame.depth = Image16(image.width, image.height);
  Image<float> meters(is_float ? image.width : 0, is_float ? image.height : 0);
  std::vector<std::byte> pixel(size);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto* at = image.data.data() + y * image.step + x * size;
      std::copy_n(at, size, pixel.begin());
      if (image.big_endian) std::ranges::reverse(pixel);
      if (is_float)
        std::memcpy(&meters.at(x, y), pixel.data(), size);
      else
        std::memcpy(&frame.depth.at(x, y), pixel.data(), size);
    }
  if (is_float) frame.depth_unit_m = round_meters(meters.data, std::nullopt, frame.depth);
}

}  // namespace

struct RosSegmenter::Data {
  Segmenter segmenter;
  std::string world_frame;
  std::optional<Intrinsics> camera;
};

RosSegmenter::RosSegmenter(const Options& options, int threads, const std::string& world_frame)
    : data_(std::make_shared<const Data>(
          Data{Segmenter(options, threads), world_frame, std::nullopt})) {}

std::vector<RosTopic> RosSegmenter::topics() {
  std::vector<RosTopic> topics;
  for (const report::RosTopic& topic : report::ros_topics())
    topics.push_back({topic.name, topic.type});
  return topics;
}

void RosSegmenter::set_camera_info(View<std::uint8_t> cdr) {
  detail::guarded([&] {
    auto data = std::make_shared<Data>(*data_);
    data->camera =
        intrinsics_of(parse(cdr, "sensor_msgs/msg/CameraInfo", [](const io::Message& message) {
          return io::ros::parse_camera_info(message);
        }));
    data_ = std::move(data);
  });
}

bool RosSegmenter::has_camera_info() const { return data_->camera.has_value(); }

void RosSegmenter::set_options(const Options& options, int threads) {
  auto data = std::make_shared<Data>(*data_);
  data->segmenter = Segmenter(options, threads);
  data_ = std::move(data);
}

std::vector<RosMessage> RosSegmenter::segment(
    View<std::uint8_t> cdr, const std::function<bool(const RosTopic&)>& wanted) const {
  return detail::guarded([&] {
    if (!data_->camera) throw Error("image: its camera_info has not arrived yet");
    ::planescope::Frame frame;
    report::RosPlace place;
    parse(cdr, "sensor_msgs/msg/Image", [&](const io::Message& message) {
      const io::ros::HeldImage held =
          io::ros::read_image(message, "sensor_msgs/Image", "sensor_msgs/msg/Image");
      take_depth(held.image, frame);
      const io::ros::Header& header = held.image.header;
      if (header.frame_id.empty())
        throw Error("image: header.frame_id is empty; expected the camera's coordinate frame");
      frame.timestamp_s = header.stamp_s;
      place = {header.stamp_ns, header.frame_id, data_->world_frame, {}, Pose::Identity()};
    });
    frame.name = fmt::format("{}", place.stamp_ns);
    frame.intrinsics = *data_->camera;
    if (frame.intrinsics.width != frame.depth.width ||
        frame.intrinsics.height != frame.depth.height)
      throw Error(fmt::format("image: {}x{} pixels, but its camera_info is for {}x{}",
                              frame.depth.width, frame.depth.height, frame.intrinsics.width,
                              frame.intrinsics.height));
    const detail::SegmenterData& segmenter = detail::Access::segmenter(data_->segmenter);
    const planes::AnalyzedFrame found =
        planes::analyze(frame, segmenter.options, segmenter.chosen.classifier.get());
    std::vector<RosMessage> messages;
    for (const report::RosTopic& topic : report::ros_topics()) {
      const RosTopic named{topic.name, topic.type};
      if (wanted && !wanted(named)) continue;
      const io::RosMessage made = topic.message(frame, found, found.found, place);
      messages.push_back({named, {made.cdr.begin(), made.cdr.end()}});
    }
    return messages;
  });
}

}  // namespace planescope::v0
