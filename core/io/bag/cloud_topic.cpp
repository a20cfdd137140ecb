// Frames from a topic of sensor_msgs/PointCloud2, organized or not: each message is a cloud.

#include <fmt/format.h>

#include <algorithm>

#include "core/io/bag/ros_messages.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

constexpr Scalar kTypes[] = {Scalar::i8,  Scalar::u8,  Scalar::i16, Scalar::u16,
                             Scalar::i32, Scalar::u32, Scalar::f32, Scalar::f64};

class CloudTopicRecording : public Recording {
 public:
  CloudTopicRecording(std::unique_ptr<MessageLog> log,
                      BagLayout layout,
                      const RecordingOptions& options)
      : log_(std::move(log)),
        layout_(std::move(layout)),
        instance_field_(options.instance_field),
        clouds_(log_->messages(layout_.depth)),
        sidecar_(read_sidecar(log_->path())) {
    if (!layout_.accel.empty()) accel_ = log_->messages(layout_.accel);
    info_.path = log_->path();
    info_.format = layout_.format;
    info_.depth_unit_m = 1;
    info_.depth_unit_source = "meters (ROS convention)";
    info_.color_note = "in the cloud, if it has any";
    info_.topic = options.topic;
    info_.topics = layout_.topics;
    info_.times_source =
        has_times(sidecar_) ? sidecar_.path.filename().string() : "message headers";
    info_.warnings = log_->warnings();
    info_.warnings.insert(info_.warnings.end(), layout_.warnings.begin(), layout_.warnings.end());
    read_cloud(0, nullptr);  // report unusable fields before work starts
    log_->expect_whole();
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(clouds_.size()); }

  Frame frame(int i) const override {
    return guarded(*log_, [&] {
      Frame frame;
      frame.index = i;
      frame.name = std::to_string(i);
      frame.depth_unit_m = info_.depth_unit_m;
      CloudExtras extras{{instance_field_}, {}};
      Cloud cloud = read_cloud(i, instance_field_.empty() ? nullptr : &extras);
      if (!instance_field_.empty()) take_instances(cloud.points, extras, what(i));
      frame.timestamp_s = cloud.header.stamp_s;
      frame.cloud = std::move(cloud.points);
      frame.gravity = gravity_near(*log_, accel_, clouds_.at(i).time_ns, layout_.R_depth_accel);
      apply_sidecar(sidecar_, frame);
      return frame;
    });
  }

  double timestamp_s(int i) const override {
    const Message message = log_->read(clouds_.at(i), ros::kHeaderBytes);
    try {
      return time_of_frame(sidecar_, std::to_string(i), ros::parse_header(message).stamp_s);
    } catch (OutOfBytes) {
      throw Error(what(i) + " is damaged");
    }
  }

  std::string frame_hash(int i) const override {
    return guarded(*log_, [&] { return sha256_of_cloud(read_cloud(i, nullptr).points); });
  }

 private:
  struct Cloud {
    ros::Header header;
    PointSet points;
  };

  std::string what(int i) const {
    return fmt::format("{}: cloud {} on {}", log_->path().string(), i, layout_.depth);
  }

  Cloud read_cloud(int i, CloudExtras* extras) const {
    const Message message = log_->read(clouds_.at(i));
    try {
      const ros::PointCloud cloud = ros::parse_point_cloud(message);
      Cloud read{cloud.header, points_of(cloud, i, extras)};
      read.points.optical = lower_case(cloud.header.frame_id).find("optical") != std::string::npos;
      return read;
    } catch (OutOfBytes) {
      throw Error(what(i) + " is damaged");
    }
  }

  /// In the order of the message, row by row.
  PointSet points_of(const ros::PointCloud& cloud, int i, CloudExtras* extras) const {
    std::vector<CloudField> fields;
    std::vector<std::size_t> offsets;
    for (const ros::PointCloud::Field& field : cloud.fields) {
      if (field.type < 1 || field.type > std::size(kTypes)) continue;
      const Scalar type = kTypes[field.type - 1];
      if (field.offset + size_of(type) > cloud.point_step)
        throw Error(fmt::format("{}: field \"{}\" at byte {} extends beyond the {}-byte point",
                                what(i), field.name, field.offset, cloud.point_step));
      fields.push_back({field.name, type});
      offsets.push_back(field.offset);
    }
    CloudBuilder builder(what(i), fields, extras);
    expect_within_read_limit(static_cast<double>(cloud.data.size()), what(i));
    builder.reserve(cloud.width * cloud.height);
    std::vector<double> values(fields.size());
    for (std::size_t row = 0; row < cloud.height; ++row)
      for (std::size_t column = 0; column < cloud.width; ++column) {
        const std::byte* point =
            cloud.data.data() + row * cloud.row_step + column * cloud.point_step;
        for (std::size_t k = 0; k < fields.size(); ++k)
          values[k] = load(fields[k].type, point + offsets[k], cloud.big_endian);
        builder.add(values);
      }
    return builder.finish();
  }

  std::unique_ptr<MessageLog> log_;
  BagLayout layout_;
  std::string instance_field_;
  std::vector<MessageRef> clouds_, accel_;
  Sidecar sidecar_;
  RecordingInfo info_;
};

}  // namespace

std::unique_ptr<Recording> open_cloud_topic(std::unique_ptr<MessageLog> log,
                                            BagLayout layout,
                                            const RecordingOptions& options) {
  return std::make_unique<CloudTopicRecording>(std::move(log), std::move(layout), options);
}

}  // namespace planescope::io
