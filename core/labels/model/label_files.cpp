// Reads, checks and writes the label files of a frame.

#include "core/labels/model/label_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/io/image/png.hpp"
#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxJsonBytes = 64u << 20;  // 65534 planes need about 15 MB

template <typename T>
std::string size_of(const Image<T>& image) {
  return fmt::format("{}x{}", image.width, image.height);
}

void check_sizes(const FrameLabels& labels, const std::string& where) {
  const Intrinsics& k = labels.intrinsics;
  if (labels.plane.empty() || labels.plane.channels != 1 || labels.hv.channels != 1)
    throw Error(
        where +
        ": invalid label images; expected a plane image and an h/v image with one channel each");
  if (labels.hv.width != labels.plane.width || labels.hv.height != labels.plane.height)
    throw Error(fmt::format("{}: the plane image is {}, but the h/v image is {}", where,
                            size_of(labels.plane), size_of(labels.hv)));
  if (labels.plane.width != k.width || labels.plane.height != k.height)
    throw Error(fmt::format("{}: the label images are {}, but the intrinsics are for {}x{}", where,
                            size_of(labels.plane), k.width, k.height));
}

/// Throws Error if the labels were made for another depth image or cloud.
void check_frame(const FrameLabels& labels,
                 const ExpectedFrame& expected,
                 const std::string& where) {
  const auto points = static_cast<std::size_t>(labels.intrinsics.width);
  if (labels.is_cloud() && expected.points > 0 && points != expected.points)
    throw Error(
        fmt::format("{}: created for a cloud with {} points, but this recording's frame has {}",
                    where, points, expected.points));
  if (!expected.sha256.empty() && labels.depth_sha256 != expected.sha256)
    throw Error(fmt::format(
        "{}: created for {} with SHA-256 {:.12}, but this recording's frame has {:.12}", where,
        labels.is_cloud() ? fmt::format("a cloud with {} points", points) : "a depth image",
        labels.depth_sha256, expected.sha256));
}

/// Converts the points of a cloud to an image that any viewer opens.
template <typename T>
Image<T> in_rows(const Image<T>& points) {
  Image<T> image(std::min(points.width, kPointsInRow),
                 (points.width + kPointsInRow - 1) / kPointsInRow);
  std::ranges::copy(points.data, image.data.begin());
  return image;
}

/// The reverse. Throws Error if there is data after the last point.
template <typename T>
Image<T> in_one_row(Image<T> image, int points, const std::string& where) {
  const auto end = image.data.begin() + points;
  if (std::any_of(end, image.data.end(), [](T value) { return value != 0; }))
    throw Error(fmt::format("{}: labels continue after the last of {} points", where, points));
  image.data.resize(static_cast<std::size_t>(points));
  image.width = points;
  image.height = 1;
  return image;
}

void check_numbers(const FrameLabels& labels, const std::string& where) {
  const Intrinsics& k = labels.intrinsics;
  bool finite = labels.gravity.direction.allFinite() && std::isfinite(labels.gravity.confidence);
  for (const double value : {k.fx, k.fy, k.cx, k.cy}) finite = finite && std::isfinite(value);
  for (const double value : k.coefficients) finite = finite && std::isfinite(value);
  for (const LabelPlane& plane : labels.planes)
    finite = finite && plane.normal.allFinite() && std::isfinite(plane.offset_m) &&
             std::isfinite(plane.rms_m) && std::isfinite(plane.tolerance_m) &&
             std::isfinite(plane.confidence);
  if (!finite) throw Error(where + ": a number is not finite");
  for (const LabelPlane& plane : labels.planes) {
    if (plane.confidence < 0 || plane.confidence > 1)
      throw Error(fmt::format("{}: plane {} has confidence {:f}; expected 0 to 1", where, plane.id,
                              plane.confidence));
    if (plane.fragments < 0)
      throw Error(fmt::format("{}: plane {} has {} fragments; expected 0 or more", where, plane.id,
                              plane.fragments));
  }
}

void check_review(const FrameLabels& labels, const std::string& where) {
  const std::size_t pixels = labels.plane.pixels();
  for (const ReviewNote& note : labels.review) {
    if (note.pixel >= pixels || note.pixels > pixels)
      throw Error(
          fmt::format("{}: a review note covers {} pixels at pixel {}, but the image has {}", where,
                      note.pixels, note.pixel, pixels));
    if (note.label_plane < 0 || note.other_plane < 0)
      throw Error(
          fmt::format("{}: a review note refers to planes {} and {}; expected ids of 0 or more",
                      where, note.label_plane, note.other_plane));
  }
}

void check_ids(const FrameLabels& labels, const std::string& where) {
  std::vector<bool> listed(kPlaneIgnore + 1, false);
  listed[0] = listed[kPlaneIgnore] = true;
  const auto fail = [&](const char* what, int value, const char* why) {
    throw Error(fmt::format("{}: {} {}{}", where, what, value, why));
  };
  for (const LabelPlane& plane : labels.planes) {
    if (plane.id < 1 || plane.id >= kPlaneIgnore)
      fail("plane id", plane.id, "; expected 1 to 65534");
    if (listed[plane.id]) fail("plane id", plane.id, " is listed twice");
    listed[plane.id] = true;
  }
  for (const std::uint16_t id : labels.plane.data)
    if (!listed[id]) fail("plane id", id, " is in the image but not in the list of planes");
  for (const std::uint8_t value : labels.hv.data)
    if (value > 2 && value != kHvIgnore) fail("h/v value", value, "; expected 0, 1, 2, or 255");
}

/// Throws Error unless the images have one channel and the size of the intrinsics, the plane ids
/// are distinct and in 1..65534, every id in the image is listed, the h/v values are known, all
/// numbers are finite, confidences are 0..1 and review notes refer to pixels of the image. The
/// message begins with `where`.
void check_labels(const FrameLabels& labels, const std::string& where) {
  check_sizes(labels, where);
  check_numbers(labels, where);
  check_ids(labels, where);
  check_review(labels, where);
}

}  // namespace

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

fs::path default_label_dir(const fs::path& recording) { return path_beside(recording, ".labels"); }

std::array<fs::path, kLabelFiles> label_file_paths(const fs::path& dir, int frame_index) {
  const std::string stem = fmt::format("{:06}", frame_index);
  return {dir / (stem + ".plane.png"), dir / (stem + ".hv.png"), dir / (stem + ".json")};
}

LabelFileBytes encode_label_files(const fs::path& dir, int frame_index, const FrameLabels& labels) {
  check_labels(labels, label_file_paths(dir, frame_index).back().string());
  const std::string json = label_json(frame_index, labels);
  const auto png = [&](const auto& image) {
    return labels.is_cloud() ? io::encode_png(in_rows(image)) : io::encode_png(image);
  };
  return {png(labels.plane), png(labels.hv), {json.begin(), json.end()}};
}

void write_label_files(const fs::path& dir, int frame_index, const LabelFileBytes& bytes) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw Error(dir.string() + ": folder cannot be created: " + error.message());
  const auto paths = label_file_paths(dir, frame_index);
  for (std::size_t i = 0; i < kLabelFiles; ++i) write_file_bytes(paths[i], bytes[i], Durable::yes);
}

void write_frame_labels(const fs::path& dir, int frame_index, const FrameLabels& labels) {
  write_label_files(dir, frame_index, encode_label_files(dir, frame_index, labels));
}

std::optional<FrameLabels> read_frame_labels(const fs::path& dir,
                                             int frame_index,
                                             const ExpectedFrame& expected) {
  const auto paths = label_file_paths(dir, frame_index);
  if (std::none_of(paths.begin(), paths.end(), is_there)) return std::nullopt;

  const auto& [plane_path, hv_path, json_path] = paths;
  const auto bytes = read_file_bytes(json_path, kMaxJsonBytes);
  FrameLabels labels =
      parse_label_json(std::string(bytes.begin(), bytes.end()), frame_index, json_path.string());
  check_frame(labels, expected, json_path.string());
  const int points = labels.intrinsics.width;
  const int width = labels.is_cloud() ? std::min(points, kPointsInRow) : labels.intrinsics.width;
  const int height =
      labels.is_cloud() ? (points + kPointsInRow - 1) / kPointsInRow : labels.intrinsics.height;
  // Headers first, so that images of the wrong size are never decoded.
  for (const fs::path& path : {plane_path, hv_path}) {
    const io::PngInfo info = io::png_info(path);
    if (info.width != width || info.height != height)
      throw Error(fmt::format("{}: {}x{} pixels, but its frame has {}x{}", path.string(),
                              info.width, info.height, width, height));
  }
  labels.plane = io::read_png_16(plane_path);
  labels.hv = io::read_png_grey(hv_path);
  if (labels.is_cloud()) {
    labels.plane = in_one_row(std::move(labels.plane), points, plane_path.string());
    labels.hv = in_one_row(std::move(labels.hv), points, hv_path.string());
  }
  check_labels(labels, json_path.string());
  return labels;
}

std::optional<FrameLabels> read_labels_of_frame(const std::filesystem::path& dir,
                                                const Frame& frame,
                                                const std::string& sha256,
                                                std::optional<int> number) {
  const std::size_t points = frame.is_cloud() ? frame.cloud->points.size() : 0;
  auto labels = read_frame_labels(dir, number.value_or(frame.index), {sha256, points});
  if (!labels) return labels;
  const std::string where = fmt::format("{}: labels of frame {}", dir.string(), frame.index);
  if (labels->is_cloud() != frame.is_cloud())
    throw Error(where + (frame.is_cloud() ? " are for a depth image, but the frame is a cloud"
                                          : " are for a cloud, but the frame is a depth image"));
  if (!frame.is_cloud() &&
      (labels->plane.width != frame.depth.width || labels->plane.height != frame.depth.height))
    throw Error(where + " are " + size_of(labels->plane) + ", but its depth image is " +
                size_of(frame.depth));
  return labels;
}

std::optional<planes::SourceTruth> frame_truth(const Frame& frame,
                                               const std::filesystem::path& label_dir,
                                               const std::string& sha256,
                                               std::optional<int> number) {
  if (!label_dir.empty())
    if (const auto labels = read_labels_of_frame(label_dir, frame, sha256, number))
      return planes::truth_of_labels(*labels);
  if (frame.is_cloud()) return planes::truth_of_cloud(*frame.cloud);
  return std::nullopt;
}

namespace {

/// Returns the frame number of a label file; nullopt for other files.
std::optional<int> number_of_file(const std::string& name) {
  constexpr std::size_t kLongestNumber = 9;  // that fits an int
  const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
  const std::string rest = name.substr(digits);
  if (digits < 6 || digits > kLongestNumber) return std::nullopt;
  if (rest != ".json" && rest != ".plane.png" && rest != ".hv.png") return std::nullopt;
  return std::stoi(name.substr(0, digits));
}

/// The frame that labels were made for. Without a hash if they are damaged, which is reported when
/// they are read.
FrameIdentity identity_of(const fs::path& dir, int number) {
  const fs::path file = label_file_paths(dir, number).back();
  try {
    const auto json = read_json<nlohmann::ordered_json>(file, kMaxJsonBytes);
    for (const char* key : {"depth_sha256", "cloud_sha256"})
      if (json.contains(key)) return {number, json.at(key).get<std::string>(), {}, 0};
  } catch (const std::exception&) {
  }
  return {number, "", {}, 0};
}

}  // namespace

std::vector<int> label_numbers(const fs::path& dir) {
  std::set<int> numbers;
  std::error_code error;
  for (auto at = fs::directory_iterator(dir, error); !error && at != fs::directory_iterator();
       at.increment(error))
    if (const auto number = number_of_file(at->path().filename().string())) numbers.insert(*number);
  if (error) throw Error(dir.string() + ": cannot be listed: " + error.message());
  return {numbers.begin(), numbers.end()};
}

LabelsOfFrames labels_of_frames(const fs::path& dir,
                                const io::Recording& recording,
                                std::span<const int> frames) {
  LabelsOfFrames labels;
  if (!is_there(dir)) return labels;
  const std::vector<int> numbers = label_numbers(dir);
  for (const int number : numbers) labels.number_of[number] = number;
  if (dynamic_cast<const io::FrameStream*>(&recording)) return labels;  // frames are yet to arrive
  std::vector<FrameIdentity> all;
  // Finds the frames of some labels. True if all are at their numbers.
  std::vector<std::optional<int>> found;
  const auto find = [&](const auto& is_wanted) {
    all.clear();
    for (const int number : numbers)
      if (is_wanted(number)) all.push_back(identity_of(dir, number));
    std::erase_if(all, [](const FrameIdentity& one) { return one.sha256.empty(); });
    found = io::find_frames(recording, all);
    return std::ranges::equal(found, all, {}, {}, &FrameIdentity::index);
  };
  if (find([&](int n) { return n == numbers.back() || std::ranges::count(frames, n) > 0; }) ||
      find([](int) { return true; }))
    return labels;
  std::vector<std::string> moved, lost;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (found[i] != all[i].index) labels.number_of.erase(all[i].index);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!found[i]) lost.push_back(fmt::format("{:06}", all[i].index));
    if (!found[i] || *found[i] == all[i].index) continue;
    labels.number_of[*found[i]] = all[i].index;
    moved.push_back(fmt::format("{:06} to frame {}", all[i].index, *found[i]));
  }
  // Labels of other pixels stay where no others are: reading them fails.
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!found[i] && all[i].index < recording.frame_count())
      labels.number_of.try_emplace(all[i].index, all[i].index);
  if (moved.empty()) return labels;
  const auto text = [](const std::vector<std::string>& all_of) {
    return all_of[0] + (all_of.size() > 1 ? fmt::format(" and {} more", all_of.size() - 1) : "");
  };
  labels.warning = fmt::format(
      "{}: labels were matched to frames by their pixels, because frames were added or removed: {}",
      dir.string(), text(moved));
  if (!lost.empty()) labels.warning += "; no frame matches " + text(lost);
  return labels;
}

// The JSON part of the label files.
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLargestUnit_m = 1;  // per count
constexpr const char* kSchema = "planescope.labels/1";

void intrinsics_fields(auto& fields, auto& k) {
  fields("width", k.width);
  fields("height", k.height);
  fields("fx", k.fx);
  fields("fy", k.fy);
  fields("cx", k.cx);
  fields("cy", k.cy);
  fields("distortion_model", k.distortion);
  fields("distortion", k.coefficients);
}

template <typename Fields>
void gravity_fields(Fields& fields, auto& gravity) {
  if constexpr (Fields::kReads) fields("source", gravity.source);  // is there a direction?
  if (gravity.known())
    fields("direction", gravity.direction);
  else if constexpr (!Fields::kReads)
    fields.null("direction");
  if constexpr (!Fields::kReads) fields("source", gravity.source);
  fields("confidence", gravity.confidence);
  fields("note", gravity.note);
}

/// Omits values that most planes share.
void plane_fields(auto& fields, auto& plane) {
  const LabelPlane usual;
  fields("id", plane.id);
  fields("label", plane.label);
  fields("normal", plane.normal);
  fields("offset_m", plane.offset_m);
  fields("rms_m", plane.rms_m);
  fields("tolerance_m", plane.tolerance_m);
  fields("fragments", plane.fragments);
  fields.with_default("origin", plane.origin, usual.origin);
  fields.with_default("confidence", plane.confidence, usual.confidence);
  fields.with_default("locked", plane.locked, false);
  fields.with_default("hidden", plane.hidden, false);
}

void note_fields(auto& fields, auto& note) {
  fields("kind", note.kind);
  fields("pixel", note.pixel);
  fields("pixels", note.pixels);
  fields("label_plane", note.label_plane);
  fields("other_plane", note.other_plane);
  fields("decision", note.decision);
  fields("reviewer", note.reviewer);
  fields("time_s", note.time_s);
}

void cloud_fields(auto& fields, auto& labels) {
  fields("cloud_sha256", labels.depth_sha256);
  fields.whole("points", labels.intrinsics.width, kPlain, 1, int{kMostPoints});
  fields.with_default("origin", labels.origin, Vec3d::Zero());
}

void image_fields(auto& fields, auto& labels) {
  fields("depth_sha256", labels.depth_sha256);
  fields.object("intrinsics", kPlain, [&](auto& of) { intrinsics_fields(of, labels.intrinsics); });
  fields.with_default("depth_unit_m", labels.depth_unit_m, 0);
}

template <typename Fields>
void label_fields(Fields& fields, auto& labels) {
  bool is_cloud = labels.is_cloud();
  if constexpr (Fields::kReads) {
    is_cloud = fields.place().has("points");
    if (is_cloud) labels.intrinsics.height = 1;
  }
  if (is_cloud)
    cloud_fields(fields, labels);
  else
    image_fields(fields, labels);
  fields.object("gravity", kPlain, [&](auto& of) { gravity_fields(of, labels.gravity); });
  fields.list("planes", labels.planes, kPlain,
              [](auto& of, auto& plane) { plane_fields(of, plane); });
  fields("annotator", labels.annotator);
  fields("review_state", labels.review_state);
  if (Fields::kReads || !labels.review.empty())
    fields.list("review", labels.review, kOptional,
                [](auto& of, auto& note) { note_fields(of, note); });
}

}  // namespace

std::string label_json(int frame_index, const FrameLabels& labels) {
  Json json = {{"schema", kSchema}, {"frame", frame_index}};
  FieldWriter fields(json);
  label_fields(fields, labels);
  return json_text(json);
}

FrameLabels parse_label_json(const std::string& text, int frame_index, const std::string& where) {
  return read_place(where, parse_json<Json>(text, where), [&](const JsonPlace& place) {
    place.schema({kSchema});
    if (const int frame = place.at("frame").whole(0); frame != frame_index)
      throw Error(
          fmt::format("labels for frame {}; expected labels for frame {}", frame, frame_index));
    FrameLabels labels;
    FieldReader fields(place);
    label_fields(fields, labels);
    if (!(labels.depth_unit_m >= 0 && labels.depth_unit_m <= kLargestUnit_m))
      place.at("depth_unit_m").fail_kind("0 to 1");
    return labels;
  });
}

}  // namespace planescope::labels
