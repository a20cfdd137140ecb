// COCO (https://cocodataset.org/#format-data). What it has no field for is in each annotation's
// "plane", which other readers of COCO ignore.

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
#include "core/model/json.hpp"

namespace planescope::labels {
namespace {

using Json = nlohmann::ordered_json;

// What our files call the classes, and how large their images may be.
constexpr int kMaxCocoSide = 1 << 16;  // of an image [px]

struct CocoCategory {
  int id;
  const char* name;
  std::uint8_t label;
};
constexpr CocoCategory kCocoCategories[] = {
    {1, "h", 1}, {2, "v", 2}, {3, "unknown", 0}, {4, "ignore", kHvIgnore}};

// Masks: runs of 0 and 1 in turn, the pixels column by column.

/// Consecutive pixels in column order u * height + v that are inside.
struct MaskRun {
  std::uint64_t first = 0, count = 0;
};

/// `sorted`: u * height + v, ascending, none twice.
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

/// Throws Error naming `where` unless the counts add up to `pixels`.
std::vector<MaskRun> mask_runs(const std::vector<std::uint64_t>& counts,
                               std::uint64_t pixels,
                               const std::string& where) {
  std::vector<MaskRun> runs;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > pixels - at)
      throw Error(where + ": its mask runs past the " + std::to_string(pixels) +
                  " pixels of the image");
    if (i % 2 == 1 && counts[i] > 0) runs.push_back({at, counts[i]});
    at += counts[i];
  }
  if (at != pixels)
    throw Error(where + ": its mask covers " + std::to_string(at) + " pixels, the image has " +
                std::to_string(pixels));
  return runs;
}

/// Pixels whose centre is inside the polygon (even-odd); (0, 0) is the upper left pixel's corner.
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

/// A whole number, however it is written; nlohmann's get<int>() accepts what does not fit.
int whole_of(const Json& json, int low, int high, const std::string& where) {
  const double value = json.get<double>();
  return whole_numbers<std::int32_t>(std::span(&value, 1), low, high, where)[0];
}

/// What is read, on the pixels of one image.
class CocoReader {
 public:
  CocoReader(const Json& json, const Json& image, const std::string& where)
      : json_(json), image_(image), where_(where) {}

  /// `annotations`: places of those of the image.
  LabelledPoints read(const std::vector<std::size_t>& annotations) {
    read_image();
    read_categories();
    const Json& all = json_.at("annotations");
    for (const std::size_t at : annotations)
      if (all[at].contains("plane")) used_.insert(own_plane_id(all[at]));
    for (const std::size_t at : annotations)
      read_annotation(all[at], where_ + ": annotation " + std::to_string(at));
    return points();
  }

 private:
  void read_image() {
    width_ = whole_of(image_.at("width"), 1, kMaxCocoSide, where_ + ": width");
    height_ = whole_of(image_.at("height"), 1, kMaxCocoSide, where_ + ": height");
    check_count(pixels(), where_);
    instance_.assign(pixels(), 0);
    label_.assign(pixels(), 0);
  }

  void read_categories() {
    for (const Json& category : json_.at("categories")) {
      const auto name = category.at("name").get<std::string>();
      const auto known = std::find_if(std::begin(kCocoCategories), std::end(kCocoCategories),
                                      [&](const CocoCategory& c) { return name == c.name; });
      if (known == std::end(kCocoCategories))
        throw Error(where_ + ": category \"" + printable(name) +
                    "\", expected h, v, unknown or ignore");
      label_of_category_[category.at("id").dump()] = known->label;
    }
  }

  int own_plane_id(const Json& annotation) const {
    return whole_of(annotation.at("plane").at("id"), 0, kPlaneIgnore, where_ + ": plane id");
  }

  /// Annotations of other tools have no plane: each is one.
  int plane_id(const Json& annotation) {
    if (annotation.contains("plane")) return own_plane_id(annotation);
    while (used_.contains(next_)) ++next_;
    if (next_ >= kPlaneIgnore) throw Error(where_ + ": more than 65534 planes");
    used_.insert(next_);
    return next_;
  }

  std::vector<MaskRun> polygons_of(const Json& segmentation, const std::string& where) const {
    std::vector<MaskRun> runs;
    for (const Json& polygon : segmentation) {
      const auto numbers = polygon.get<std::vector<double>>();
      std::vector<std::pair<double, double>> corners;
      for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
        if (std::max(std::abs(numbers[i]), std::abs(numbers[i + 1])) > kMaxCocoSide)
          throw Error(where + ": a polygon that runs far out of the image");
        corners.emplace_back(numbers[i], numbers[i + 1]);
      }
      const auto more = polygon_runs(corners, width_, height_);
      runs.insert(runs.end(), more.begin(), more.end());
    }
    return runs;
  }

  std::vector<MaskRun> runs_of(const Json& segmentation, const std::string& where) const {
    if (segmentation.is_array()) return polygons_of(segmentation, where);
    const auto size = segmentation.at("size").get<std::array<int, 2>>();
    if (size[0] != height_ || size[1] != width_)
      throw Error(where + ": a mask of " + std::to_string(size[1]) + "x" + std::to_string(size[0]) +
                  ", the image is " + std::to_string(width_) + "x" + std::to_string(height_));
    const Json& counts = segmentation.at("counts");
    if (counts.is_string())
      return mask_runs(counts_of_text(counts.get<std::string>(), where), pixels(), where);
    const auto whole = whole_numbers<std::int32_t>(counts.get<std::vector<double>>(), 0,
                                                   kMaxLabelledPoints, where + ": counts");
    return mask_runs({whole.begin(), whole.end()}, pixels(), where);
  }

  void read_annotation(const Json& annotation, const std::string& where) {
    const auto label = label_of_category_.find(annotation.at("category_id").dump());
    if (label == label_of_category_.end())
      throw Error(where + ": of a category that the file does not have");
    const int id = plane_id(annotation);
    for (const MaskRun& run : runs_of(annotation.at("segmentation"), where)) {
      for (std::uint64_t at = run.first; at < run.first + run.count; ++at) {
        const std::size_t pixel = at % height_ * static_cast<std::size_t>(width_) + at / height_;
        instance_[pixel] = id;
        label_[pixel] = label->second;
      }
    }
    if (annotation.contains("plane") && annotation["plane"].contains("normal"))
      read_plane(annotation["plane"], id, label->second);
  }

  void read_plane(const Json& json, int id, std::uint8_t label) {
    LabelPlane plane;
    plane.id = id;
    plane.label = label == kHvIgnore ? Label::unknown : static_cast<Label>(label);
    const auto normal = json.at("normal").get<std::array<double, 3>>();
    plane.normal = Vec3d(normal[0], normal[1], normal[2]);
    plane.offset_m = json.at("offset_m").get<double>();
    plane.rms_m = json.at("rms_m").get<double>();
    planes_.push_back(plane);
  }

  LabelledPoints points() {
    LabelledPoints points;
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

  const Json& json_;
  const Json& image_;
  const std::string& where_;
  int width_ = 0, height_ = 0;
  std::map<std::string, std::uint8_t> label_of_category_;  // by the id as it is written
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

Json plane_json(int id, const LabelledPoints& points) {
  Json json = {{"id", id}};
  for (const LabelPlane& plane : points.planes) {
    if (plane.id != id) continue;
    json["normal"] = {plane.normal.x(), plane.normal.y(), plane.normal.z()};
    json["offset_m"] = plane.offset_m;
    json["rms_m"] = plane.rms_m;
  }
  return json;
}

/// By plane, then class: one mask for each plane, unless its pixels differ in class.
std::map<std::pair<int, int>, Mask> masks_of(const LabelledPoints& points) {
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

// As rleFrString of pycocotools: groups of five bits, the lowest first, 48 added; from the fourth
// on counts are differences to the one before the last.
std::vector<std::uint64_t> counts_of_text(const std::string& text, const std::string& where) {
  std::vector<std::uint64_t> counts;
  for (std::size_t i = 0; i < text.size();) {
    std::int64_t value = 0;
    int shift = 0;
    bool more = true;
    while (more) {
      const int code = i < text.size() ? text[i] - 48 : -1;
      if (code < 0 || code > 63 || shift > 40)
        throw Error(where + ": its compressed mask is damaged at character " + std::to_string(i));
      value |= static_cast<std::int64_t>(code & 31) << shift;
      more = (code & 32) != 0;
      shift += 5;
      ++i;
      if (!more && (code & 16) != 0) value -= std::int64_t{1} << shift;
    }
    if (counts.size() > 2) value += static_cast<std::int64_t>(counts[counts.size() - 2]);
    if (value < 0)
      throw Error(where + ": its compressed mask has a run of " + std::to_string(value) +
                  " pixels");
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
  try {
    auto parsed = std::make_shared<Parsed>();
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    parsed->where = where;
    parsed->json = parse_json<Json>(text, where + ": not a COCO file");
    std::map<std::string, std::size_t> image_of_id;  // by the id as it is written
    for (const Json& image : parsed->json.at("images")) {
      if (!image_of_id.emplace(image.at("id").dump(), names_.size()).second)
        throw Error(where + ": two images with id " + printable(image.at("id").dump()));
      names_.push_back(image.value("file_name", ""));
    }
    parsed->annotations.resize(names_.size());
    const Json none = Json::array();
    const auto found = parsed->json.find("annotations");  // missing: points() says so
    const Json& annotations = found == parsed->json.end() ? none : *found;
    for (std::size_t i = 0; i < annotations.size(); ++i) {
      const auto image = image_of_id.find(annotations[i].at("image_id").dump());
      if (image == image_of_id.end())
        throw Error(where + ": annotation " + std::to_string(i) +
                    ": of an image that the file does not have");
      parsed->annotations[image->second].push_back(i);
    }
    parsed_ = std::move(parsed);
  } catch (const Json::exception& error) {
    throw Error(where + ": not a COCO file (" + error.what() + ")");
  }
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

LabelledPoints CocoFile::points(std::size_t image) const {
  try {
    return CocoReader(parsed_->json, parsed_->json.at("images").at(image), parsed_->where)
        .read(parsed_->annotations[image]);
  } catch (const Json::exception& error) {
    throw Error(parsed_->where + ": not a COCO file (" + error.what() + ")");
  }
}

LabelledPoints parse_coco(io::Bytes bytes, const std::string& where) {
  const CocoFile file(bytes, where);
  if (file.names().size() != 1)
    throw Error(where + ": " + std::to_string(file.names().size()) + " images, expected one");
  return file.points(0);
}

struct CocoWriter::Made {
  Json images = Json::array(), annotations = Json::array();
};

CocoWriter::CocoWriter() : made_(std::make_unique<Made>()) {}
CocoWriter::~CocoWriter() = default;

void CocoWriter::add(const LabelledPoints& points, const std::string& file_name) {
  const std::size_t image_id = made_->images.size() + 1;
  made_->images.push_back({{"id", image_id},
                           {"width", points.width},
                           {"height", points.height},
                           {"file_name", file_name}});
  const auto pixels =
      static_cast<std::uint64_t>(points.width) * static_cast<std::uint64_t>(points.height);
  for (const auto& [key, mask] : masks_of(points)) {
    const auto category =
        std::find_if(std::begin(kCocoCategories), std::end(kCocoCategories),
                     [&, label = key.second](const CocoCategory& c) { return c.label == label; });
    made_->annotations.push_back(
        {{"id", made_->annotations.size() + 1},
         {"image_id", image_id},
         {"category_id", category->id},
         {"iscrowd", category->label == kHvIgnore ? 1 : 0},  // crowds are not scored
         {"area", mask.sorted.size()},
         {"bbox", {mask.left, mask.top, mask.right - mask.left + 1, mask.bottom - mask.top + 1}},
         {"segmentation",
          {{"size", {points.height, points.width}}, {"counts", mask_counts(mask.sorted, pixels)}}},
         {"plane", plane_json(key.first, points)}});
  }
}

FileBytes CocoWriter::bytes() const {
  Json json;
  json["info"] = {{"description", "Planes of depth images, by planescope"}, {"version", "1"}};
  json["images"] = made_->images;
  json["categories"] = Json::array();
  for (const CocoCategory& category : kCocoCategories)
    json["categories"].push_back(
        {{"id", category.id}, {"name", category.name}, {"supercategory", "plane"}});
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
  // 2 % at either end are left out: a few far pixels must not make the rest of it white.
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
