#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/labels/exchange/coco_categories.hpp"
#include "core/labels/exchange/coco_mask.hpp"
#include "core/labels/exchange/exchange_files.hpp"

// COCO (https://cocodataset.org/#format-data), one image. The rest is in each annotation's "plane",
// which other readers of COCO ignore.
namespace planescope::labels {
namespace {

using Json = nlohmann::ordered_json;

/// A whole number, however it is written; nlohmann's get<int>() accepts what does not fit.
int whole_of(const Json& json, int low, int high, const std::string& where) {
  const double value = json.get<double>();
  return whole_numbers<std::int32_t>(std::span(&value, 1), low, high, where)[0];
}

/// What is read, on the image's pixels.
class CocoReader {
 public:
  CocoReader(const Json& json, const std::string& where) : json_(json), where_(where) {}

  LabelledPoints read() {
    read_image();
    read_categories();
    for (const Json& annotation : json_.at("annotations"))
      if (annotation.contains("plane")) used_.insert(own_plane_id(annotation));
    std::size_t number = 0;
    for (const Json& annotation : json_.at("annotations"))
      read_annotation(annotation, where_ + ": annotation " + std::to_string(number++));
    return points();
  }

 private:
  void read_image() {
    const Json& images = json_.at("images");
    if (images.size() != 1)
      throw Error(where_ + ": " + std::to_string(images.size()) + " images, expected one");
    image_id_ = images.at(0).at("id");
    width_ = whole_of(images.at(0).at("width"), 1, kMaxCocoSide, where_ + ": width");
    height_ = whole_of(images.at(0).at("height"), 1, kMaxCocoSide, where_ + ": height");
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
    if (annotation.at("image_id") != image_id_)
      throw Error(where + ": of an image that the file does not have");
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
  const std::string& where_;
  Json image_id_;
  int width_ = 0, height_ = 0;
  std::map<std::string, std::uint8_t> label_of_category_;  // by the id as it is written
  std::set<int> used_;
  int next_ = 1;
  std::vector<std::int32_t> instance_;
  std::vector<std::uint8_t> label_;
  std::vector<LabelPlane> planes_;
};

}  // namespace

LabelledPoints parse_coco(io::Bytes file, const std::string& where) {
  try {
    const auto* text = reinterpret_cast<const char*>(file.data());
    const Json json = Json::parse(text, text + file.size());
    return CocoReader(json, where).read();
  } catch (const Json::exception& error) {
    throw Error(where + ": not a COCO file (" + error.what() + ")");
  }
}

}  // namespace planescope::labels
