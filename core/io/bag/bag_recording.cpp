// Recordings of the RealSense SDK and of realsense-ros, in any container.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/io/bag/ros_messages.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace {

constexpr double kMaxColorGap_s = 0.5;
constexpr double kClocksDiffer_s = 10;

class BagRecording : public Recording {
 public:
  BagRecording(std::unique_ptr<MessageLog> log, BagLayout layout, const RecordingOptions& options);

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(depth_.size()); }
  Frame frame(int i) const override;
  double timestamp_s(int i) const override;
  std::string frame_hash(int i) const override;

 private:
  struct DepthMessage {
    ros::Header header;
    std::optional<double> unit_m;
    Image16 depth;
    std::vector<float> meters;  // 32FC1: as recorded
  };
  DepthMessage read_depth(int i) const;
  void add_color(const MessageRef& depth, double stamp_s, Frame& frame) const;
  const MessageRef* nearest_color(const MessageRef& depth, double stamp_s) const;
  double color_gap_s(std::size_t color, double depth_stamp_s) const;
  void order_by_stamp();
  ros::HeldImage image_of(const Message& message, const std::string& topic) const;
  ros::CameraInfo read_camera_info(const MessageRef& message, const std::string& topic) const;
  ros::SdkFrameFacts facts_beside(const MessageRef& depth) const;
  void name_frame(int i, const ros::Header& header, Frame& frame) const;
  void read_camera(const RecordingOptions& options);
  void drop_unreadable_color();
  void read_color_camera();

  std::unique_ptr<MessageLog> log_;
  const MessageLog& bag_;
  BagLayout layout_;
  RecordingInfo info_;
  Sidecar sidecar_;
  bool reads_color_ = true;
  bool unit_is_given_ = false;  // by option or sidecar; overrides the units of single frames
  Intrinsics color_intrinsics_;
  std::vector<MessageRef> depth_;
  std::vector<MessageRef> metadata_;  // SDK texts beside depth
  std::vector<MessageRef> color_;
  std::vector<MessageRef> accel_;
  double color_period_s_ = 0;
};

struct PixelLayout {
  int channels = 0;
  int red = 0, green = 0, blue = 0;
};

PixelLayout layout_of(const std::string& encoding) {
  if (encoding == "rgb8" || encoding == "8UC3") return {3, 0, 1, 2};
  if (encoding == "bgr8") return {3, 2, 1, 0};
  if (encoding == "rgba8" || encoding == "8UC4") return {4, 0, 1, 2};
  if (encoding == "bgra8") return {4, 2, 1, 0};
  if (encoding == "mono8" || encoding == "8UC1") return {1, 0, 0, 0};
  return {};
}

constexpr const char* kMeters = "32FC1";

/// Throws Error naming bag and topic unless the image holds 16-bit depth counts or meters.
void check_depth_encoding(const ros::Image& image,
                          const std::filesystem::path& bag,
                          const std::string& topic) {
  const std::string what = fmt::format("{}: depth images on {} are ", bag.string(), topic);
  if (image.lossy)
    throw Error(what +
                "compressed as JPEG, which does not preserve depth; expected compressedDepth, PNG, "
                "or zstd");
  if (image.encoding != "mono16" && image.encoding != "16UC1" && image.encoding != kMeters)
    throw Error(fmt::format(
        "{}encoded as \"{}\"; expected mono16 or 16UC1 (16-bit counts), or 32FC1 (meters)", what,
        image.encoding));
}

/// The pixels without the padding after each row. Throws OutOfBytes if the image is incomplete.
template <typename T>
std::vector<T> pixels_of(const ros::Image& image) {
  const std::size_t row_bytes = sizeof(T) * image.width;
  if (image.width == 0 || image.height == 0 || image.step < row_bytes) throw OutOfBytes{};
  std::vector<T> pixels(static_cast<std::size_t>(image.width) * image.height);
  auto* to = reinterpret_cast<std::byte*>(pixels.data());
  for (int y = 0; y < image.height; ++y)
    std::memcpy(to + y * row_bytes, image.data.data() + y * image.step, row_bytes);
  if (image.big_endian)
    for (std::size_t at = 0; at < pixels.size() * sizeof(T); at += sizeof(T))
      std::reverse(to + at, to + at + sizeof(T));
  return pixels;
}

/// Supports rgb8, bgr8, rgba8, bgra8, mono8 and 8UC1. Throws Error on any other encoding.
Image8 to_rgb(const ros::Image& image, const std::filesystem::path& bag, const std::string& topic) {
  const PixelLayout layout = layout_of(image.encoding);
  if (layout.channels == 0)
    throw Error(
        fmt::format("{}: color images on {} are encoded as \"{}\"; expected rgb8, bgr8, "
                    "rgba8, bgra8, or mono8",
                    bag.string(), topic, image.encoding));
  const std::size_t row_bytes = std::size_t(layout.channels) * image.width;
  if (image.width == 0 || image.height == 0 || image.step < row_bytes) throw OutOfBytes{};
  Image8 rgb(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(image.data.data() + y * image.step);
    std::uint8_t* to = &rgb.at(0, y);
    for (int x = 0; x < image.width; ++x, from += layout.channels, to += 3) {
      to[0] = from[layout.red];
      to[1] = from[layout.green];
      to[2] = from[layout.blue];
    }
  }
  return rgb;
}

/// Reads a message, or its first bytes, and passes it to `parse`.
template <typename Parse>
auto parse_message(const MessageLog& bag,
                   const MessageRef& message,
                   const std::string& topic,
                   Parse parse,
                   std::size_t at_most = kWholeMessage) {
  const Message bytes = bag.read(message, at_most);
  try {
    return parse(bytes);
  } catch (OutOfBytes) {
    throw Error(bag.path().string() + ": a message on " + topic + " is damaged");
  }
}

double median_period_s(const std::vector<MessageRef>& messages) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < messages.size(); ++i) {
    periods.push_back(1e-9 * static_cast<double>(messages[i].time_ns - messages[i - 1].time_ns));
  }
  if (periods.empty()) return 0;
  std::nth_element(periods.begin(), periods.begin() + periods.size() / 2, periods.end());
  return periods[periods.size() / 2];
}

Intrinsics to_intrinsics(const ros::CameraInfo& camera,
                         const std::string& topic,
                         std::vector<std::string>& warnings) {
  Intrinsics result{camera.width,   camera.height,  camera.k(0, 0),   camera.k(1, 1),
                    camera.k(0, 2), camera.k(1, 2), Distortion::none, {}};
  if (!set_distortion(camera.distortion_model, camera.d, result)) {
    warnings.push_back(topic + ": lens distortion \"" + camera.distortion_model +
                       "\" is not supported and is ignored");
  }
  return result;
}

BagRecording::BagRecording(std::unique_ptr<MessageLog> log,
                           BagLayout layout,
                           const RecordingOptions& options)
    : log_(std::move(log)),
      bag_(*log_),
      layout_(std::move(layout)),
      sidecar_(read_sidecar(bag_.path())) {
  info_.path = bag_.path();
  info_.format = layout_.format;
  info_.device = layout_.device;
  info_.topic = options.topic;
  info_.topics = layout_.topics;
  info_.warnings = bag_.warnings();
  reads_color_ = options.color;
  unit_is_given_ = options.depth_unit_m || sidecar_.depth_unit_m;
  depth_ = bag_.messages(layout_.depth);
  order_by_stamp();
  if (!layout_.depth_metadata.empty()) metadata_ = bag_.messages(layout_.depth_metadata);
  if (!layout_.color.empty()) color_ = bag_.messages(layout_.color);
  if (!layout_.accel.empty()) accel_ = bag_.messages(layout_.accel);
  color_period_s_ = median_period_s(color_);
  if (!info_.warnings.empty())
    info_.warnings.front() +=
        fmt::format(", including {} depth and {} color images", depth_.size(), color_.size());
  info_.warnings.insert(info_.warnings.end(), layout_.warnings.begin(), layout_.warnings.end());
  read_camera(options);
  read_color_camera();
  info_.times_source = has_times(sidecar_) ? sidecar_.path.filename().string()
                       : metadata_.empty() ? "message headers"
                                           : "frame metadata";
  bag_.expect_whole();
}

/// Frames are sorted by the sensor's clock. In practice that is the recording order; it is checked
/// only where that does not require unpacking the whole file.
void BagRecording::order_by_stamp() {
  constexpr std::size_t kCheapMessages = 64;
  bool suspicious = false;
  for (std::size_t i = 1; i < depth_.size(); ++i) {
    const MessageRef& a = depth_[i - 1];
    const MessageRef& b = depth_[i];
    suspicious = suspicious || a.time_ns == b.time_ns || a.place() > b.place();
  }
  if (!suspicious && depth_.size() > kCheapMessages) return;
  std::vector<std::tuple<double, std::uint32_t, std::size_t>> order;
  try {
    for (std::size_t i = 0; i < depth_.size(); ++i) {
      const auto header =
          parse_message(bag_, depth_[i], layout_.depth, ros::parse_header, ros::kHeaderBytes);
      order.emplace_back(header.stamp_s, header.seq.value_or(0), i);
    }
  } catch (const Error&) {
    return;  // a damaged frame: reported when it is read; keep the order
  }
  std::sort(order.begin(), order.end());
  std::vector<MessageRef> sorted;
  for (const auto& [stamp_s, seq, i] : order) sorted.push_back(depth_[i]);
  depth_ = std::move(sorted);
}

ros::HeldImage BagRecording::image_of(const Message& message, const std::string& topic) const {
  return ros::read_image(message, bag_.topics().at(topic),
                         bag_.path().string() + ": an image on " + topic);
}

ros::CameraInfo BagRecording::read_camera_info(const MessageRef& message,
                                               const std::string& topic) const {
  return parse_message(bag_, message, topic,
                       layout_.is_sdk ? ros::parse_sdk_camera_info : ros::parse_camera_info);
}

/// The metadata that the SDK recorded with a depth image, at the same time.
ros::SdkFrameFacts BagRecording::facts_beside(const MessageRef& depth) const {
  const auto found = std::lower_bound(metadata_.begin(), metadata_.end(), depth.time_ns,
                                      [](const MessageRef& m, auto t) { return m.time_ns < t; });
  if (found == metadata_.end() || found->time_ns != depth.time_ns) return {};
  return parse_message(bag_, *found, layout_.depth_metadata, ros::parse_sdk_metadata);
}

void BagRecording::read_camera(const RecordingOptions& options) {
  CameraFacts facts;
  const auto image = parse_message(bag_, depth_.front(), layout_.depth, [&](const Message& bytes) {
    auto parsed = image_of(bytes, layout_.depth).image;
    info_.rounded = parsed.encoding == kMeters;
    try {
      const auto meters = info_.rounded ? pixels_of<float>(parsed) : std::vector<float>();
      Image16 counts(static_cast<int>(meters.size()), 1);
      if (info_.rounded) facts.depth_unit_m = round_meters(meters, std::nullopt, counts);
    } catch (const OutOfBytes&) {
      // Reported when the frame is read.
    }
    parsed.data = {};  // keep only the header
    return parsed;
  });
  check_depth_encoding(image, bag_.path(), layout_.depth);
  info_.width = image.width;
  info_.height = image.height;
  const auto& infos = bag_.messages(layout_.depth_info);
  if (!infos.empty()) {
    const auto camera = read_camera_info(infos.front(), layout_.depth_info);
    facts.intrinsics = to_intrinsics(camera, layout_.depth_info, info_.warnings);
    facts.intrinsics_source = "bag topic " + layout_.depth_info;
  }
  if (info_.rounded) {
    facts.depth_unit_source = "rounding step of the 32FC1 depth in meters";
  } else if (!layout_.depth_unit.empty()) {
    facts.depth_unit_m = parse_message(bag_, bag_.messages(layout_.depth_unit).front(),
                                       layout_.depth_unit, ros::parse_sdk_option);
    facts.depth_unit_source = "bag topic " + layout_.depth_unit;
  } else if (const auto unit = facts_beside(depth_.front()).depth_unit_m) {
    facts.depth_unit_m = unit;
    facts.depth_unit_source = "bag topic " + layout_.depth_metadata;
  } else if (image.depth_unit_m) {
    facts.depth_unit_m = ros::decimal(*image.depth_unit_m);
    facts.depth_unit_source = "depth messages in the bag";
  } else if (image.encoding == "16UC1") {
    facts.depth_unit_m = 0.001;
    facts.depth_unit_source = "ROS convention (16UC1 is in millimeters)";
  }
  settle_camera(options, sidecar_, facts, info_);
}

/// Color in an unsupported encoding must not make the depth frames unreadable.
void BagRecording::drop_unreadable_color() {
  if (color_.empty()) return;
  try {
    parse_message(bag_, color_.front(), layout_.color, [&](const Message& bytes) {
      return to_rgb(image_of(bytes, layout_.color).image, bag_.path(), layout_.color);
    });
  } catch (const Error& error) {
    info_.warnings.push_back(std::string(error.what()) + "; color is skipped");
    color_.clear();
  }
}

void BagRecording::read_color_camera() {
  drop_unreadable_color();
  info_.has_color = !color_.empty();
  if (!info_.has_color) {
    info_.color_note = "none";
    return;
  }
  if (layout_.color_aligned) {
    info_.color_note = "aligned";
    color_intrinsics_ = info_.intrinsics;
  }
  const auto& infos = bag_.messages(layout_.color_info);
  if (layout_.color_aligned) {
    if (infos.empty() || !reads_color_) return;
    const ros::CameraInfo color = read_camera_info(infos.front(), layout_.color_info);
    return add_view_warning(color.width, color.k(0, 0), info_);
  }
  if (infos.empty() || !layout_.has_extrinsics) {
    info_.color_note = infos.empty() ? "display only: the bag has no color intrinsics"
                                     : "display only: the bag has no depth-to-color extrinsics";
    return;
  }
  const auto camera = read_camera_info(infos.front(), layout_.color_info);
  color_intrinsics_ = to_intrinsics(camera, layout_.color_info, info_.warnings);
  info_.color_note = "projected by extrinsics";
}

double BagRecording::color_gap_s(std::size_t color, double depth_stamp_s) const {
  const auto header =
      parse_message(bag_, color_[color], layout_.color, ros::parse_header, ros::kHeaderBytes);
  return std::abs(header.stamp_s - depth_stamp_s);
}

/// The color image whose stamp is nearest to that of the depth image; null if there is none nearby.
/// The search starts at the nearest recording time, so that few chunks need unpacking.
const MessageRef* BagRecording::nearest_color(const MessageRef& depth, double stamp_s) const {
  if (color_.empty()) return nullptr;
  const auto recorded_gap_s = [&](std::size_t i) {
    return std::abs(1e-9 *
                    (static_cast<double>(color_[i].time_ns) - static_cast<double>(depth.time_ns)));
  };
  const auto after = std::lower_bound(color_.begin(), color_.end(), depth.time_ns,
                                      [](const MessageRef& m, auto t) { return m.time_ns < t; });
  auto best = static_cast<std::size_t>(after - color_.begin());
  if (best == color_.size()) --best;
  if (best > 0 && recorded_gap_s(best - 1) < recorded_gap_s(best)) --best;
  double gap_s = color_gap_s(best, stamp_s);
  if (gap_s > kClocksDiffer_s) {
    gap_s = recorded_gap_s(best);  // the two sensors do not share a clock
  } else {
    const double surely_nearest_s = 0.4 * color_period_s_;
    for (const int step : {-1, +1}) {
      while (gap_s > surely_nearest_s) {
        const auto next = static_cast<std::ptrdiff_t>(best) + step;
        if (next < 0 || next >= static_cast<std::ptrdiff_t>(color_.size())) break;
        const double next_gap_s = color_gap_s(static_cast<std::size_t>(next), stamp_s);
        if (next_gap_s >= gap_s) break;
        best = static_cast<std::size_t>(next);
        gap_s = next_gap_s;
      }
    }
  }
  return gap_s <= kMaxColorGap_s ? &color_[best] : nullptr;
}

void BagRecording::add_color(const MessageRef& depth, double stamp_s, Frame& frame) const {
  const MessageRef* color = reads_color_ ? nearest_color(depth, stamp_s) : nullptr;
  if (!color) return;
  frame.color = parse_message(bag_, *color, layout_.color, [&](const Message& bytes) {
    return to_rgb(image_of(bytes, layout_.color).image, bag_.path(), layout_.color);
  });
  frame.color_aligned = layout_.color_aligned && frame.color.width == frame.depth.width &&
                        frame.color.height == frame.depth.height;
  frame.color_intrinsics = color_intrinsics_;
  frame.T_color_depth = layout_.T_color_depth;
}

/// Sets name, time and unit of frame i. The unit is already set if the image contains it.
void BagRecording::name_frame(int i, const ros::Header& header, Frame& frame) const {
  const ros::SdkFrameFacts facts = facts_beside(depth_.at(i));
  frame.name = facts.number.value_or(std::to_string(header.seq.value_or(i)));
  frame.timestamp_s = facts.timestamp_s.value_or(header.stamp_s);
  if (facts.depth_unit_m && !info_.rounded) frame.depth_unit_m = *facts.depth_unit_m;
  if (unit_is_given_ || frame.depth_unit_m == 0) frame.depth_unit_m = info_.depth_unit_m;
}

BagRecording::DepthMessage BagRecording::read_depth(int i) const {
  return parse_message(bag_, depth_.at(i), layout_.depth, [&](const Message& bytes) {
    const ros::HeldImage unpacked = image_of(bytes, layout_.depth);
    const ros::Image& image = unpacked.image;
    if (image.width != info_.width || image.height != info_.height)
      throw Error(fmt::format(
          "{}: depth frame {} is {}x{}; expected {}x{}, the size of the first frame",
          bag_.path().string(), i, image.width, image.height, info_.width, info_.height));
    check_depth_encoding(image, bag_.path(), layout_.depth);
    if ((image.encoding == kMeters) != info_.rounded)
      throw Error(fmt::format("{}: depth frame {} is encoded as \"{}\", but the first frame is not",
                              bag_.path().string(), i, image.encoding));
    DepthMessage result{image.header, std::nullopt, Image16(image.width, image.height), {}};
    if (info_.rounded) {
      std::optional<double> given_m;
      if (unit_is_given_) given_m = info_.depth_unit_m;
      result.meters = pixels_of<float>(image);
      result.unit_m = round_meters(result.meters, given_m, result.depth);
      return result;
    }
    result.depth.data = pixels_of<std::uint16_t>(image);
    if (image.depth_unit_m) result.unit_m = ros::decimal(*image.depth_unit_m);
    return result;
  });
}

Frame BagRecording::frame(int i) const {
  return guarded(bag_, [&] {
    Frame frame;
    frame.index = i;
    DepthMessage message = read_depth(i);
    frame.depth = std::move(message.depth);
    frame.depth_unit_m = message.unit_m.value_or(0);
    name_frame(i, message.header, frame);
    frame.intrinsics = info_.intrinsics;
    add_color(depth_[i], message.header.stamp_s, frame);
    frame.gravity = gravity_near(bag_, accel_, depth_[i].time_ns, layout_.R_depth_accel);
    apply_sidecar(sidecar_, frame);
    return frame;
  });
}

double BagRecording::timestamp_s(int i) const {
  Frame facts;
  name_frame(i,
             parse_message(bag_, depth_.at(i), layout_.depth, ros::parse_header, ros::kHeaderBytes),
             facts);
  return time_of_frame(sidecar_, facts.name, facts.timestamp_s);
}

std::string BagRecording::frame_hash(int i) const {
  return guarded(bag_, [&] {
    const DepthMessage message = read_depth(i);
    return info_.rounded ? sha256_hex(std::as_bytes(std::span(message.meters)))
                         : sha256_of_depth(message.depth);
  });
}

}  // namespace

std::unique_ptr<Recording> open_bag(const std::filesystem::path& path,
                                    const RecordingOptions& options) {
  std::unique_ptr<MessageLog> log = open_message_log(path);
  BagLayout layout = find_bag_layout(*log, options.topic);
  if (layout.is_cloud) return open_cloud_topic(std::move(log), std::move(layout), options);
  return std::make_unique<BagRecording>(std::move(log), std::move(layout), options);
}

}  // namespace planescope::io
