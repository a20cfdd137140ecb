// Frames of the public library: conversion to core's frames, and their accessors.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/io/recording.hpp"
#include "core/planes/cloud/camera.hpp"
#include "library/data.hpp"

namespace planescope::v0 {
namespace detail {
namespace {

// Largest inputs: core's indices must hold them, and larger ones are probably mistakes.
constexpr int kMaxSide = 16384;
constexpr std::size_t kMaxPoints = std::size_t{1} << 25;
constexpr double kWidestView = 11.4;  // width / focal length: 160 degrees

Intrinsics intrinsics(const Camera& camera, const char* what) {
  if (camera.width < 1 || camera.height < 1 || camera.width > kMaxSide || camera.height > kMaxSide)
    throw Error(fmt::format("{}: {}x{} pixels; expected 1 to {} in each direction", what,
                            camera.width, camera.height, kMaxSide));
  if (!(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy)))
    throw Error(fmt::format("{}: focal length {}, {} px; expected values above 0", what, camera.fx,
                            camera.fy));
  if (camera.width > kWidestView * camera.fx || camera.height > kWidestView * camera.fy)
    throw Error(
        fmt::format("{}: focal length {:g}, {:g} px for {}x{} pixels, a field of view of more than "
                    "160 degrees; "
                    "expected fx, fy, cx, and cy in pixels",
                    what, camera.fx, camera.fy, camera.width, camera.height));
  if (!(std::isfinite(camera.cx) && std::isfinite(camera.cy)))
    throw Error(fmt::format("{}: principal point {}, {}; expected finite numbers, in pixels", what,
                            camera.cx, camera.cy));
  if (static_cast<int>(camera.distortion) > static_cast<int>(Distortion::inverse_brown_conrady))
    throw Error(fmt::format("{}: unknown distortion {}; expected 0 to 2", what,
                            static_cast<int>(camera.distortion)));
  for (const double coefficient : camera.coefficients)
    if (!std::isfinite(coefficient))
      throw Error(fmt::format("{}: distortion coefficient {}; expected a finite number", what,
                              coefficient));
  Intrinsics result;
  result.width = camera.width;
  result.height = camera.height;
  result.fx = camera.fx;
  result.fy = camera.fy;
  result.cx = camera.cx;
  result.cy = camera.cy;
  result.distortion = static_cast<::planescope::Distortion>(camera.distortion);
  result.coefficients = camera.coefficients;
  return result;
}

std::optional<::planescope::Gravity> given_gravity(const std::optional<Vec3>& direction) {
  if (!direction) return std::nullopt;
  const Vec3d d = vec3(*direction);
  if (!d.allFinite() || d.isZero(1e-9))
    throw Error(
        fmt::format("gravity: {}, {}, {}; expected a nonzero direction", d.x(), d.y(), d.z()));
  return ::planescope::Gravity{d.stableNormalized(), GravitySource::option, 1, "given"};
}

static_assert(static_cast<int>(Distortion::inverse_brown_conrady) ==
              static_cast<int>(::planescope::Distortion::inverse_brown_conrady));

}  // namespace

Pose pose(const Transform& t, const char* what) {
  Pose pose = Pose::Identity();
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) pose.matrix()(r, c) = t[static_cast<std::size_t>(r) * 4 + c];
  const Mat3d r = pose.linear();
  if (!pose.matrix().allFinite() || (r * r.transpose() - Mat3d::Identity()).norm() > 1e-3 ||
      r.determinant() < 0)
    throw Error(fmt::format("{}: not a rigid transform", what));
  return pose;
}

Transform transform(const Pose& pose) {
  Transform t{};
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) t[static_cast<std::size_t>(r) * 4 + c] = pose.matrix()(r, c);
  return t;
}

Camera camera(const Intrinsics& intrinsics) {
  return {intrinsics.width,
          intrinsics.height,
          intrinsics.fx,
          intrinsics.fy,
          intrinsics.cx,
          intrinsics.cy,
          static_cast<Distortion>(intrinsics.distortion),
          intrinsics.coefficients};
}

/// Throws Error if the image cannot be read as described.
static Intrinsics checked(const DepthImage& image) {
  const Intrinsics result = intrinsics(image.camera, "depth image");
  if (image.counts == nullptr && image.meters == nullptr) throw Error("depth image: no pixels");
  if (!(image.unit_m > 0 && image.unit_m <= 1))
    throw Error(fmt::format("depth image: {} m per count; expected more than 0 and at most 1",
                            image.unit_m));
  if (image.row_stride != 0 && image.row_stride < static_cast<std::size_t>(result.width))
    throw Error(fmt::format("depth image: row stride {1}; expected at least the width, {0}",
                            result.width, image.row_stride));
  return result;
}

v0::Frame Access::frame(::planescope::Frame&& frame) {
  v0::Frame result;
  result.data_ = std::make_shared<const ::planescope::Frame>(std::move(frame));
  return result;
}

void throw_for_programs(const std::string& message) {
  std::string text = message;
  const auto replace = [&text](std::string_view what, std::string_view by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what))
      text.replace(at, what.size(), by);
  };
  replace(planes::kHowToGiveGravity, "specify the downward direction in the sensor's frame");
  replace(io::kHowToGiveIntrinsics, "specify them");
  replace(" --", " ");
  replace("(--", "(");
  throw Error(text);
}

}  // namespace detail

using detail::Access;

Error::~Error() = default;

namespace {

constexpr const char* kGivenName = "0";  // name of frames without a recording, in messages

/// Stores depth in meters as counts and returns their unit.
double store_meters(const DepthImage& image, std::size_t stride, Image16& depth) {
  std::vector<float> meters;
  for (int y = 0; y < depth.height; ++y) {
    const float* row = image.meters + y * stride;
    meters.insert(meters.end(), row, row + depth.width);
  }
  const double unit_m = round_meters(meters, std::nullopt, depth);
  const auto is_far = [](std::uint16_t count) { return count == planes::kFarOutlier; };
  const auto is_near = [&](std::uint16_t count) { return count > 0 && !is_far(count); };
  if (std::ranges::any_of(depth.data, is_far) && std::ranges::none_of(depth.data, is_near))
    throw Error("depth image: every pixel is beyond 65.5 m; expected depth in meters");
  return unit_m;
}

constexpr std::string_view kMagic = "planescope frame 1\n";

class Writer {
 public:
  explicit Writer(std::string& bytes) : bytes_(bytes) {}
  void raw(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  template <typename List>
  void list(const List& list) {
    const std::uint64_t size = list.size();
    raw(&size, sizeof(size));
    raw(list.data(), size * sizeof(*list.data()));
  }
  template <typename T, typename Visit>
  void optional(const std::optional<T>& value, const Visit& visit) {
    bytes_ += value ? '\1' : '\0';
    if (value) visit(*value);
  }

 private:
  std::string& bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  void raw(void* data, std::size_t size) {
    expect(size <= bytes_.size());
    std::copy_n(bytes_.data(), size, static_cast<char*>(data));
    bytes_.remove_prefix(size);
  }
  template <typename List>
  void list(List& list) {
    std::uint64_t size = 0;
    raw(&size, sizeof(size));
    expect(size <= bytes_.size() / sizeof(*list.data()));
    list.resize(size);
    raw(list.data(), size * sizeof(*list.data()));
  }
  template <typename T, typename Visit>
  void optional(std::optional<T>& value, const Visit& visit) {
    char has = 0;
    raw(&has, 1);
    if (has != 0) visit(value.emplace());
  }
  void end() const { expect(bytes_.empty()); }
  static void expect(bool holds) {
    if (!holds) throw Error("frame: damaged bytes; expected the output of Frame::bytes()");
  }

 private:
  std::string_view bytes_;
};

/// Visits every field of a frame that a caller or a recording can set.
template <typename Archive, typename AFrame>
void visit_frame(Archive& archive, AFrame& frame) {
  const auto number = [&](auto& value) { archive.raw(&value, sizeof(value)); };
  const auto image = [&](auto& of) {
    number(of.width), number(of.height), number(of.channels);
    archive.list(of.data);
  };
  const auto vector = [&](auto& v) { archive.raw(v.data(), sizeof(double) * v.size()); };
  const auto camera = [&](auto& k) {
    number(k.width), number(k.height), number(k.fx), number(k.fy), number(k.cx), number(k.cy);
    number(k.distortion), number(k.coefficients);
  };
  number(frame.index), number(frame.timestamp_s), number(frame.depth_unit_m);
  number(frame.color_aligned);
  archive.list(frame.name);
  image(frame.depth), image(frame.color);
  camera(frame.intrinsics), camera(frame.color_intrinsics);
  vector(frame.T_color_depth.matrix());
  archive.optional(frame.T_world_camera, [&](auto& pose) { vector(pose.matrix()); });
  archive.optional(frame.gravity, [&](auto& gravity) {
    vector(gravity.direction);
    number(gravity.source), number(gravity.confidence);
    archive.list(gravity.note);
  });
  archive.optional(frame.cloud, [&](auto& cloud) {
    vector(cloud.origin);
    archive.list(cloud.points), archive.list(cloud.rgb);
    archive.list(cloud.label), archive.list(cloud.instance);
  });
}

}  // namespace

Frame::Frame(const DepthImage& image) {
  detail::guarded([&] {
    ::planescope::Frame frame;
    frame.name = kGivenName;
    frame.intrinsics = detail::checked(image);
    const auto width = static_cast<std::size_t>(image.camera.width);
    const std::size_t stride = image.row_stride == 0 ? width : image.row_stride;
    frame.depth = Image16(image.camera.width, image.camera.height);
    frame.depth_unit_m = image.unit_m;
    if (image.counts == nullptr) frame.depth_unit_m = store_meters(image, stride, frame.depth);
    for (int y = 0; y < image.camera.height && image.counts != nullptr; ++y)
      std::copy_n(image.counts + y * stride, width, &frame.depth.at(0, y));
    frame.gravity = detail::given_gravity(image.gravity);
    if (const ColorImage& color = image.color; color.rgb != nullptr) {
      frame.color_aligned = color.aligned;
      if (color.aligned) {
        const bool sized = color.camera.width != 0 || color.camera.height != 0;
        if (sized && (color.camera.width != image.camera.width ||
                      color.camera.height != image.camera.height))
          throw Error(fmt::format("color image: {}x{} pixels, aligned with depth; expected {}x{}",
                                  color.camera.width, color.camera.height, image.camera.width,
                                  image.camera.height));
        frame.color = Image8(image.camera.width, image.camera.height, 3);
      } else {
        Camera camera = color.camera;
        if (camera.fx == 0) camera.fx = camera.fy = 1;  // displayed, not projected
        frame.color_intrinsics = detail::intrinsics(camera, "color image");
        if (color.camera.fx == 0) frame.color_intrinsics.fx = frame.color_intrinsics.fy = 0;
        frame.T_color_depth = detail::pose(color.T_color_depth, "color image, T_color_depth");
        frame.color = Image8(camera.width, camera.height, 3);
      }
      std::copy_n(color.rgb, frame.color.data.size(), frame.color.data.data());
    }
    *this = Access::frame(std::move(frame));
  });
}

Frame::Frame(const PointCloud& cloud) {
  detail::guarded([&] {
    if (cloud.xyz == nullptr || cloud.size == 0) throw Error("point cloud: no points");
    if (cloud.size > detail::kMaxPoints)
      throw Error(fmt::format("point cloud: {} points; expected at most {}", cloud.size,
                              detail::kMaxPoints));
    ::planescope::Frame frame;
    frame.name = kGivenName;
    std::vector<Vec3d> points;
    points.reserve(cloud.size);
    for (std::size_t i = 0; i < cloud.size; ++i)
      points.emplace_back(cloud.xyz[3 * i], cloud.xyz[3 * i + 1], cloud.xyz[3 * i + 2]);
    PointSet set;
    set.origin = bulk_origin(points);
    set.points.reserve(points.size());
    for (const Vec3d& p : points)
      // (0, 0, 0) means not measured, but relative to another origin it would be a valid point.
      set.points.push_back(p.isZero(0) && !set.origin.isZero(0)
                               ? Vec3f::Constant(std::nanf("")).eval()
                               : Vec3d(p - set.origin).cast<float>().eval());
    if (cloud.rgb != nullptr) set.rgb.assign(cloud.rgb, cloud.rgb + 3 * cloud.size);
    frame.cloud = std::move(set);
    frame.gravity = detail::given_gravity(cloud.gravity);
    *this = Access::frame(std::move(frame));
  });
}

int Frame::index() const { return Access::frame(*this).index; }
std::string Frame::name() && { return Access::frame(*this).name; }
const std::string& Frame::name() const& { return Access::frame(*this).name; }
double Frame::timestamp_s() const { return Access::frame(*this).timestamp_s; }
bool Frame::is_cloud() const { return Access::frame(*this).is_cloud(); }

std::size_t Frame::size() const {
  const ::planescope::Frame& frame = Access::frame(*this);
  return frame.is_cloud() ? frame.cloud->points.size() : frame.depth.pixels();
}

DepthImage Frame::depth() const& {
  const ::planescope::Frame& frame = Access::frame(*this);
  DepthImage image;
  if (frame.is_cloud()) return image;
  image.counts = frame.depth.data.data();
  image.camera = detail::camera(frame.intrinsics);
  image.unit_m = frame.depth_unit_m;
  if (frame.gravity) image.gravity = detail::vec3(frame.gravity->direction);
  if (!frame.color.empty()) {
    image.color.rgb = frame.color.data.data();
    image.color.camera = detail::camera(frame.color_intrinsics);
    image.color.camera.width = frame.color.width;
    image.color.camera.height = frame.color.height;
    image.color.aligned = frame.color_aligned;
    image.color.T_color_depth = detail::transform(frame.T_color_depth);
  }
  return image;
}

std::vector<Vec3> Frame::points() const {
  return detail::guarded([&] {
    const ::planescope::Frame& frame = Access::frame(*this);
    std::vector<Vec3> points;
    if (!frame.is_cloud()) return points;
    points.reserve(frame.cloud->points.size());
    for (const Vec3f& p : frame.cloud->points)
      points.push_back(detail::vec3(Vec3d(frame.cloud->origin + p.cast<double>())));
    return points;
  });
}

std::optional<Gravity> Frame::gravity() const {
  const ::planescope::Frame& frame = Access::frame(*this);
  if (!frame.gravity) return std::nullopt;
  return Gravity{detail::vec3(frame.gravity->direction), to_string(frame.gravity->source),
                 frame.gravity->confidence};
}

std::string Frame::bytes() const {
  std::string bytes(kMagic);
  Writer writer(bytes);
  visit_frame(writer, Access::frame(*this));
  return bytes;
}

Frame Frame::from_bytes(const std::string& bytes) {
  return detail::guarded([&] {
    Reader::expect(bytes.starts_with(kMagic));
    Reader reader(std::string_view(bytes).substr(kMagic.size()));
    ::planescope::Frame frame;
    visit_frame(reader, frame);
    reader.end();
    const auto fits = [](const auto& image) {
      return image.width >= 0 && image.height >= 0 && image.width <= detail::kMaxSide &&
             image.height <= detail::kMaxSide &&
             image.data.size() == image.pixels() * static_cast<std::size_t>(image.channels);
    };
    Reader::expect(fits(frame.depth) && fits(frame.color));
    return Access::frame(std::move(frame));
  });
}

}  // namespace planescope::v0
