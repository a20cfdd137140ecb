// COCO (https://cocodataset.org/#format-data). Data without a field in COCO is stored in each
// annotation's "plane", which other readers of COCO ignore.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/labels/exchange/formats.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"

namespace planescope::labels {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxCocoSide = 1 << 16;  // of an image [px]

constexpr const char* kCategoryNames[] = {"h", "v", "unknown", "ignore"};  // ids from 1 on
constexpr std::uint8_t kCategoryLabels[] = {1, 2, 0, kHvIgnore};

// Masks: alternating runs of 0 and 1, in column order.

/// Consecutive pixels inside a mask, in column order u * height + v.
struct MaskRun {
  std::uint64_t first = 0, count = 0;
};

/// `sorted`: u * height + v, ascending and unique.
std::vector<std::uint64_t> mask_counts(const std::vector<std::uint64_t>& sorted,
                                       std::uint64_t pixels) {
  std::vector<std::uint64_t> counts;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i + 1;
    while (end < sorted.size() && sorted[end] == sorted[end - 1] + 1) ++end;
    counts.push_back(sorted[i] - at);
    counts.push_back(end - i);
    at = sorted[end - 1] + 1;
    i = end;
  }
  counts.push_back(pixels - at);
  return counts;
}

/// Throws Error naming the place unless the counts add up to `pixels`.
std::vector<MaskRun> mask_runs(const std::vector<std::uint64_t>& counts,
                               std::uint64_t pixels,
                               const JsonPlace& place) {
  std::vector<MaskRun> runs;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > pixels - at) place.fail_kind(fmt::format("runs that cover {} pixels", pixels));
    if (i % 2 == 1 && counts[i] > 0) runs.push_back({at, counts[i]});
    at += counts[i];
  }
  if (at != pixels)
    place.fail_kind(fmt::format("runs that cover {} pixels (found {})", pixels, at));
  return runs;
}

/// Pixels with centers inside the polygon (even-odd); (0, 0) is the upper left pixel's corner.
std::vector<MaskRun> polygon_runs(const std::vector<std::pair<double, double>>& corners,
                                  int width,
                                  int height) {
  std::vector<MaskRun> runs;
  std::vector<double> crossings;
  for (int u = 0; u < width; ++u) {
    const double x = u + 0.5;
    crossings.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto& [ax, ay] = corners[i];
      const auto& [bx, by] = corners[(i + 1) % corners.size()];
      if ((ax <= x) != (bx <= x)) crossings.push_back(ay + (x - ax) / (bx - ax) * (by - ay));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const auto row = [&](double y) {
        return static_cast<int>(std::clamp(std::ceil(y - 0.5), 0.0, static_cast<double>(height)));
      };
      const int first = row(crossings[i]), end = row(crossings[i + 1]);
      if (first < end)
        runs.push_back({static_cast<std::uint64_t>(u) * static_cast<std::uint64_t>(height) +
                            static_cast<std::uint64_t>(first),
                        static_cast<std::uint64_t>(end - first)});
    }
  }
  return runs;
}

/// A whole number, also if it is written as 4.0.
int whole_of(const JsonPlace& place, int low, int high) {
  const double value = place.number();
  if (!(value >= low && value <= high) || value != std::floor(value))
    place.fail_kind(fmt::format("a whole number from {} to {}", low, high));
  return static_cast<int>(value);
}

/// Ids may be numbers or text; compare their JSON.
std::string id_of(const JsonPlace& place, const char* key) { return place.at(key).json().dump(); }

void plane_fields(auto& fields, Same<LabelPlane> auto& plane) {
  fields("normal", plane.normal);
  fields("offset_m", plane.offset_m);
  fields("rms_m", plane.rms_m);
}

/// Reads the annotations of one image.
class CocoReader {
 public:
  CocoReader(const JsonPlace& file, const JsonPlace& image, const std::string& where) {
    width_ = whole_of(image.at("width"), 1, kMaxCocoSide);
    height_ = whole_of(image.at("height"), 1, kMaxCocoSide);
    check_count(pixels(), where);
    instance_.assign(pixels(), 0);
    label_.assign(pixels(), 0);
    file.at("categories").each([&](const JsonPlace& category) {
      const std::size_t known = category.at("name").choice(kCategoryNames);
      label_of_category_[id_of(category, "id")] = kCategoryLabels[known];
    });
  }

  LabeledPoints read(const std::vector<JsonPlace>& annotations) {
    for (const JsonPlace& annotation : annotations)
      if (annotation.has("plane")) used_.insert(own_plane_id(annotation));
    for (const JsonPlace& annotation : annotations) read_annotation(annotation);
    return points();
  }

 private:
  static int own_plane_id(const JsonPlace& annotation) {
    return whole_of(annotation.at("plane").at("id"), 0, kPlaneIgnore);
  }

  /// Other tools' annotations have no plane id: each becomes a plane.
  int plane_id(const JsonPlace& annotation) {
    if (annotation.has("plane")) return own_plane_id(annotation);
    while (used_.contains(next_)) ++next_;
    if (next_ >= kPlaneIgnore) throw Error("more than 65534 planes");
    used_.insert(next_);
    return next_;
  }

  std::vector<MaskRun> runs_of(const JsonPlace& segmentation) const {
    std::vector<MaskRun> runs;
    if (segmentation.json().is_array()) {
      segmentation.each([&](const JsonPlace& polygon) {
        std::vector<double> numbers;
        polygon.each([&](const JsonPlace& number) { numbers.push_back(number.number()); });
        std::vector<std::pair<double, double>> corners;
        for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
          if (std::max(std::abs(numbers[i]), std::abs(numbers[i + 1])) > kMaxCocoSide)
            polygon.fail_kind("corners in or near the image");
          corners.emplace_back(numbers[i], numbers[i + 1]);
        }
        const auto more = polygon_runs(corners, width_, height_);
        runs.insert(runs.end(), more.begin(), more.end());
      });
      return runs;
    }
    if (const JsonPlace size = segmentation.at("size"); size.json() != Json{height_, width_})
      size.fail_kind(fmt::format("[{},{}], the size of the image", height_, width_));
    const JsonPlace place = segmentation.at("counts");
    if (!place.json().is_string()) {
      std::vector<std::uint64_t> counts;
      place.each([&](const JsonPlace& count) {
        counts.push_back(static_cast<std::uint64_t>(whole_of(count, 0, kMaxLabeledPoints)));
      });
      return mask_runs(counts, pixels(), place);
    }
    const auto counts = counts_of_text(place.text());
    if (!counts) place.fail_kind("a compressed mask");
    return mask_runs(*counts, pixels(), place);
  }

  void read_annotation(const JsonPlace& annotation) {
    const auto label = label_of_category_.find(id_of(annotation, "category_id"));
    if (label == label_of_category_.end())
      annotation.at("category_id")
          .fail(
              fmt::format("is {}, but no category has this id", id_of(annotation, "category_id")));
    const int id = plane_id(annotation);
    for (const MaskRun& run : runs_of(annotation.at("segmentation"))) {
      for (std::uint64_t at = run.first; at < run.first + run.count; ++at) {
        const std::size_t pixel = at % height_ * static_cast<std::size_t>(width_) + at / height_;
        instance_[pixel] = id;
        label_[pixel] = label->second;
      }
    }
    if (!annotation.has("plane") || !annotation.at("plane").has("normal")) return;
    LabelPlane plane;
    plane.id = id;
    if (label->second != kHvIgnore) plane.label = static_cast<Label>(label->second);
    FieldReader fields(annotation.at("plane"));
    plane_fields(fields, plane);
    planes_.push_back(plane);
  }

  LabeledPoints points() {
    LabeledPoints points;
    points.width = width_;
    points.height = height_;
    points.planes = std::move(planes_);
    for (std::size_t i = 0; i < pixels(); ++i) {
      if (instance_[i] == 0 && label_[i] == 0) continue;
      points.instance.push_back(instance_[i]);
      points.label.push_back(label_[i]);
      points.pixel.push_back({static_cast<std::uint16_t>(i % static_cast<std::size_t>(width_)),
                              static_cast<std::uint16_t>(i / static_cast<std::size_t>(width_))});
    }
    return points;
  }

  std::uint64_t pixels() const {
    return static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_);
  }

  int width_ = 0, height_ = 0;
  std::map<std::string, std::uint8_t> label_of_category_;  // by the JSON of its id
  std::set<int> used_;
  int next_ = 1;
  std::vector<std::int32_t> instance_;
  std::vector<std::uint8_t> label_;
  std::vector<LabelPlane> planes_;
};

struct Mask {
  std::vector<std::uint64_t> sorted;  // u * height + v
  int left = kMaxCocoSide, top = kMaxCocoSide, right = 0, bottom = 0;
};

/// By plane, then class: one mask for each plane, unless its pixels differ in class.
std::map<std::pair<int, int>, Mask> masks_of(const LabeledPoints& points) {
  std::map<std::pair<int, int>, Mask> masks;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int label = points.label.empty() ? 0 : points.label[i];
    if (points.instance[i] == 0 && label == 0) continue;
    const auto [u, v] = points.pixel[i];
    Mask& mask = masks[{points.instance[i], label}];
    mask.sorted.push_back(
        static_cast<std::uint64_t>(u) * static_cast<std::uint64_t>(points.height) + v);
    mask.left = std::min<int>(mask.left, u);
    mask.right = std::max<int>(mask.right, u);
    mask.top = std::min<int>(mask.top, v);
    mask.bottom = std::max<int>(mask.bottom, v);
  }
  for (auto& [key, mask] : masks) std::sort(mask.sorted.begin(), mask.sorted.end());
  return masks;
}

}  // namespace

// Like rleFrString of pycocotools: groups of five bits, the lowest first, plus 48. From the fourth
// count on, counts are differences from the one before the last.
std::optional<std::vector<std::uint64_t>> counts_of_text(const std::string& text) {
  std::vector<std::uint64_t> counts;
  for (std::size_t i = 0; i < text.size();) {
    std::int64_t value = 0;
    int shift = 0;
    bool more = true;
    while (more) {
      const int code = i < text.size() ? text[i] - 48 : -1;
      if (code < 0 || code > 63 || shift > 40) return std::nullopt;
      value |= static_cast<std::int64_t>(code & 31) << shift;
      more = (code & 32) != 0;
      shift += 5;
      ++i;
      if (!more && (code & 16) != 0) value -= std::int64_t{1} << shift;
    }
    if (counts.size() > 2) value += static_cast<std::int64_t>(counts[counts.size() - 2]);
    if (value < 0) return std::nullopt;
    counts.push_back(static_cast<std::uint64_t>(value));
  }
  return counts;
}

struct CocoFile::Parsed {
  std::string where;
  Json json;
  std::vector<std::vector<std::size_t>> annotations;  // of each image
};

CocoFile::CocoFile(io::Bytes file, const std::string& where) {
  auto parsed = std::make_shared<Parsed>();
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  parsed->where = where;
  parsed->json = parse_json<Json>(text, where + ": not a COCO file");
  read_place(where, parsed->json, [&](const JsonPlace& root) {
    std::map<std::string, std::size_t> image_of_id;
    root.at("images").each([&](const JsonPlace& image) {
      if (!image_of_id.emplace(id_of(image, "id"), names_.size()).second)
        image.at("id").fail_kind("a unique id");
      names_.push_back(image.has("file_name") ? image.at("file_name").text() : "");
    });
    parsed->annotations.resize(names_.size());
    if (!root.has("annotations")) return;  // points() reports it
    std::size_t at = 0;
    root.at("annotations").each([&](const JsonPlace& annotation) {
      const auto image = image_of_id.find(id_of(annotation, "image_id"));
      if (image == image_of_id.end())
        annotation.at("image_id")
            .fail(fmt::format("is {}, but no image has this id", id_of(annotation, "image_id")));
      parsed->annotations[image->second].push_back(at++);
    });
  });
  parsed_ = std::move(parsed);
}

CocoFile read_coco(const std::filesystem::path& path) {
  const FileBytes bytes = read_file_bytes(path);
  return {std::as_bytes(std::span(bytes)), path.string()};
}

std::optional<std::size_t> CocoFile::image_of_frame(int frame) const {
  char stem[16];
  std::snprintf(stem, sizeof(stem), "%06d", frame);
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (std::filesystem::path(names_[i]).stem() == stem) return i;
  return std::nullopt;
}

LabeledPoints CocoFile::points(std::size_t image) const {
  return read_place(parsed_->where, parsed_->json, [&](const JsonPlace& file) {
    const std::string where = fmt::format("images[{}]", image);
    CocoReader reader(file, JsonPlace(file.at("images").json()[image], where), where);
    std::vector<JsonPlace> annotations;
    const Json& all = file.at("annotations").json();
    for (const std::size_t at : parsed_->annotations[image])
      annotations.emplace_back(all[at], fmt::format("annotations[{}]", at));
    return reader.read(annotations);
  });
}

LabeledPoints parse_coco(io::Bytes bytes, const std::string& where) {
  const CocoFile file(bytes, where);
  if (file.names().size() != 1)
    throw Error(where + ": " + std::to_string(file.names().size()) + " images; expected one");
  return file.points(0);
}

struct CocoWriter::Made {
  Json images = Json::array(), annotations = Json::array();
};

CocoWriter::CocoWriter() : made_(std::make_unique<Made>()) {}
CocoWriter::~CocoWriter() = default;

void CocoWriter::add(const LabeledPoints& points, const std::string& file_name) {
  const std::size_t image_id = made_->images.size() + 1;
  made_->images.push_back({{"id", image_id},
                           {"width", points.width},
                           {"height", points.height},
                           {"file_name", file_name}});
  const auto pixels =
      static_cast<std::uint64_t>(points.width) * static_cast<std::uint64_t>(points.height);
  for (const auto& [key, mask] : masks_of(points)) {
    const auto category = std::ranges::find(kCategoryLabels, key.second);
    const auto plane = std::ranges::find(points.planes, key.first, &LabelPlane::id);
    Json plane_json = {{"id", key.first}};
    FieldWriter fields(plane_json);
    if (plane != points.planes.end()) plane_fields(fields, *plane);
    made_->annotations.push_back(
        {{"id", made_->annotations.size() + 1},
         {"image_id", image_id},
         {"category_id", 1 + (category - std::begin(kCategoryLabels))},
         {"iscrowd", *category == kHvIgnore ? 1 : 0},  // crowds are not scored
         {"area", mask.sorted.size()},
         {"bbox", {mask.left, mask.top, mask.right - mask.left + 1, mask.bottom - mask.top + 1}},
         {"segmentation",
          {{"size", {points.height, points.width}}, {"counts", mask_counts(mask.sorted, pixels)}}},
         {"plane", std::move(plane_json)}});
  }
}

FileBytes CocoWriter::bytes() const {
  Json json;
  json["info"] = {{"description", "Planes of depth images, by planescope"}, {"version", "1"}};
  json["images"] = made_->images;
  json["categories"] = Json::array();
  for (std::size_t k = 0; k < std::size(kCategoryNames); ++k)
    json["categories"].push_back(
        {{"id", k + 1}, {"name", kCategoryNames[k]}, {"supercategory", "plane"}});
  json["annotations"] = made_->annotations;
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return {text.begin(), text.end()};
}

Image8 coco_picture(const LabelGrid& grid) {
  if (!grid.color.empty()) return grid.color;
  std::vector<float> depths;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (grid.measured[i]) depths.push_back(grid.points[i].z());
  Image8 picture(grid.width, grid.height, 1);
  if (depths.empty()) return picture;
  // Ignore 2 % at either end: a few far pixels must not turn the rest white.
  const auto quantile = [&](double share) {
    const auto at = depths.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), at, depths.end());
    return *at;
  };
  const float near_m = quantile(0.02), far_m = std::max(quantile(0.98), near_m + 1e-3f);
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const float away = std::clamp((grid.points[i].z() - near_m) / (far_m - near_m), 0.0f, 1.0f);
    picture.data[i] = static_cast<std::uint8_t>(std::lround(255 - 215 * away));
  }
  return picture;
}

}  // namespace planescope::labels
