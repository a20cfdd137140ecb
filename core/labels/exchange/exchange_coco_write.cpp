#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/labels/exchange/coco_categories.hpp"
#include "core/labels/exchange/coco_mask.hpp"
#include "core/labels/exchange/exchange_files.hpp"

namespace planescope::labels {
namespace {

using Json = nlohmann::ordered_json;

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

FileBytes coco_bytes(const LabelledPoints& points, const std::string& name) {
  Json json;
  json["info"] = {{"description", "Planes of a depth image, by planescope"}, {"version", "1"}};
  json["images"] = Json::array({{{"id", 1},
                                 {"width", points.width},
                                 {"height", points.height},
                                 {"file_name", name + ".png"}}});
  json["categories"] = Json::array();
  for (const CocoCategory& category : kCocoCategories)
    json["categories"].push_back(
        {{"id", category.id}, {"name", category.name}, {"supercategory", "plane"}});
  json["annotations"] = Json::array();
  const auto pixels =
      static_cast<std::uint64_t>(points.width) * static_cast<std::uint64_t>(points.height);
  for (const auto& [key, mask] : masks_of(points)) {
    const auto category =
        std::find_if(std::begin(kCocoCategories), std::end(kCocoCategories),
                     [&, label = key.second](const CocoCategory& c) { return c.label == label; });
    json["annotations"].push_back(
        {{"id", json["annotations"].size() + 1},
         {"image_id", 1},
         {"category_id", category->id},
         {"iscrowd", 1},
         {"area", mask.sorted.size()},
         {"bbox", {mask.left, mask.top, mask.right - mask.left + 1, mask.bottom - mask.top + 1}},
         {"segmentation",
          {{"size", {points.height, points.width}}, {"counts", mask_counts(mask.sorted, pixels)}}},
         {"plane", plane_json(key.first, points)}});
  }
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return {text.begin(), text.end()};
}

}  // namespace planescope::labels
