// Draw lists and pictures of a frame's result: labels, cases, planes, leftovers and errors.

#include "render/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "render/paint.hpp"
#include "render/plane_colors.hpp"
#include "render/scenes.hpp"

namespace planescope::render {

// ---- Points: by label, by margin, unassigned, by height ----

namespace {

using Symbol = LegendEntry::Symbol;
constexpr float kUnsure = 0.5F;              // margins below this count as unsure
constexpr Rgba kLeftOver{213, 60, 20, 255};  // for pictures about unassigned points

/// The voxels, colored by color(index).
template <typename Color>
DrawList voxel_scene(const planes::FrameResult& result,
                     const std::string& title,
                     const Color& color) {
  DrawList list;
  list.title = title;
  DrawPoints& points = list.points.emplace_back(voxel_points(result.voxels));
  for (std::size_t i = 0; i < points.positions.size(); ++i) points.colors.push_back(color(i));
  return list;
}

/// The points inside range and cube as dots, colored by color(index in the cloud).
template <typename Color>
DrawList cloud_scene(const planes::Cloud& cloud, const std::string& title, const Color& color) {
  DrawList list;
  list.title = title;
  DrawPoints& points = list.points.emplace_back();
  points.size_m = 0.012F;
  points.min_px = 2.5F;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    points.positions.push_back(cloud.points[i]);
    points.colors.push_back(color(i));
  }
  return list;
}

std::string points_text(const DrawList& list) {
  return std::to_string(list.points[0].positions.size()) + " points";
}

}  // namespace

DrawList scene_labels(const planes::FrameResult& result) {
  const std::vector<Label>& labels = result.classification.labels;
  DrawList list = voxel_scene(result, "Pointwise classification",
                              [&](std::size_t i) { return label_color(labels[i]); });
  add_gravity(result, list);
  list.subtitle = std::to_string(labels.size()) + " voxels, by tilt of the surrounding surface";
  for (const auto& [label, name] :
       {std::pair(Label::h, "horizontal, up to 45\u00b0"), std::pair(Label::v, "vertical"),
        std::pair(Label::unknown, "unknown")}) {
    const auto k = static_cast<std::size_t>(std::ranges::count(labels, label));
    if (k > 0 || label != Label::unknown)
      list.explain(label_color(label),
                   fmt::format("{}  {}  ({})", name, k, percent(k, labels.size())));
  }
  return list;
}

DrawList scene_margins(const planes::FrameResult& result) {
  const planes::Classification& classified = result.classification;
  const std::size_t n = classified.labels.size();
  std::size_t unsure = 0, unknown = 0;
  DrawList list = voxel_scene(result, "Confidence of the classification", [&](std::size_t i) {
    const bool is_known = classified.labels[i] != Label::unknown;
    unknown += !is_known;
    unsure += is_known && classified.margins[i] < kUnsure;
    return margin_color(classified.labels[i], classified.margins[i]);
  });
  add_gravity(result, list);
  list.subtitle =
      fmt::format("{} of {} voxels have a margin below 0.5 ({})", unsure, n, percent(unsure, n));
  list.explain(margin_color(Label::h, 1), "h  sure (margin 1)");
  list.explain(margin_color(Label::h, 0.5), "h  margin 0.5");
  list.explain(margin_color(Label::h, 0), "on the boundary (margin 0)");
  list.explain(margin_color(Label::v, 0.5), "v  margin 0.5");
  list.explain(margin_color(Label::v, 1), "v  sure (margin 1)");
  if (unknown > 0) list.explain(label_color(Label::unknown), "unknown  " + std::to_string(unknown));
  return list;
}

DrawList scene_leftovers(const planes::FrameResult& result, std::span<const int> color_of_plane) {
  std::size_t left = 0;
  DrawList list = voxel_scene(result, "Unassigned points", [&](std::size_t i) {
    const std::int32_t id = result.segmentation.plane_of[i];
    left += id <= 0;
    return id > 0 ? mix(color_of(id, color_of_plane), kSceneFaded, 0.75) : kLeftOver;
  });
  const std::size_t n = result.voxels.points.size();
  add_gravity(result, list);
  list.subtitle = fmt::format("{} of {} voxels are in no plane ({})", left, n, percent(left, n));
  list.explain(kLeftOver, "in no plane  " + std::to_string(left));
  list.explain(kSceneFaded, "in a plane  " + std::to_string(n - left));
  return list;
}

DrawList scene_heights(const planes::FrameResult& result) {
  const RobustBounds bounds = robust_bounds(result.voxels.points);
  const double low = bounds.low.z(), high = std::max(bounds.high.z(), bounds.low.z() + 1e-3F);
  const auto color_at = [&](double z) {
    return ramp_color(1 - std::clamp((z - low) / (high - low), 0.001, 1.0));
  };
  DrawList list = cloud_scene(result.cloud, "Measured points by height",
                              [&](std::size_t i) { return color_at(result.cloud.points[i].z()); });
  list.subtitle = points_text(list);
  for (int k = 4; k >= 0; --k) {
    const double z = low + (high - low) * k / 4;
    list.explain(color_at(z), fmt::format("z = {:.2f} m", z + result.cloud.origin.z()));
  }
  add_gravity(result, list);
  return list;
}

// ---- Octree nodes by case: panels a-d of the paper's figure, for real data ----

namespace {

struct Numeral {
  const planes::OctreeNode* node = nullptr;
  Vec3f at;
};

/// Numerals on the largest settled nodes, so that cases are distinguishable without color.
void add_numerals(std::vector<Numeral> numerals, DrawList& list) {
  std::ranges::stable_sort(numerals, [](const Numeral& a, const Numeral& b) {
    return a.node->depth != b.node->depth ? a.node->depth < b.node->depth
                                          : a.node->size() > b.node->size();
  });
  if (numerals.size() > kMostNumerals) numerals.resize(kMostNumerals);
  for (const auto& [node, at] : numerals)
    list.labels.push_back({at, case_numeral(*node), kSceneText, 15, kNumeralLabel});
}

}  // namespace

DrawList scene_cases(const planes::FrameResult& result) {
  const planes::Octree& octree = result.segmentation.octree;
  DrawList list;
  std::size_t count[5] = {}, hatched = 0, label_fits = 0;
  DrawPoints points = voxel_points(result.voxels);
  points.colors.assign(points.positions.size(), case_color(planes::Case::none));
  DrawPoints fitted;  // markers of nodes that were fitted label by label
  fitted.size_m = 0;
  fitted.min_px = 6;
  const double least_edge_m = least_numeral_edge_m(result.voxels.points);
  std::vector<Numeral> numerals;
  for (const planes::OctreeNode& node : octree.nodes) {
    if (node.decided == planes::Case::none) continue;
    ++count[static_cast<int>(node.decided)];
    const bool is_divided = node.first_child >= 0;
    DrawBox box =
        is_divided ? cell_box(octree, node) : points_box(octree, node, result.voxels.size_m);
    box.color = case_color(node.decided);
    if (is_divided) {
      box.color.a = 40;  // the finer nodes inside matter more
    } else {
      for (const std::uint32_t voxel : members(octree, node)) points.colors[voxel] = box.color;
      if (node.at_max_depth) {
        box.style = BoxStyle::hatched;
        ++hatched;
      }
      label_fits += node.by_label;
      if (numeral_edge_m(octree, node, box) >= least_edge_m)
        numerals.push_back({&node, middle_of(box)});
      else if (node.by_label)  // larger nodes get a numeral with a star
        fitted.positions.push_back(middle_of(box));
    }
    list.boxes.push_back(box);
  }
  list.points.push_back(std::move(points));
  add_numerals(std::move(numerals), list);

  list.title = "Octree nodes by case";
  list.subtitle = std::to_string(result.segmentation.counts.nodes_visited) +
                  " nodes visited; voxels in the color of the node that decided them";
  add_case_legend(count, result.segmentation.octree.image.has_value(), list);
  if (hatched > 0)
    list.explain(case_color(planes::Case::III),
                 "I or III at the deepest level: unassigned  " + std::to_string(hatched),
                 Symbol::hatched_box);
  if (label_fits > 0)
    list.explain(kSceneText, "or I*: fitted label by label  " + std::to_string(label_fits));
  fitted.colors.assign(fitted.positions.size(), kSceneText);
  list.points.push_back(std::move(fitted));
  add_gravity(result, list);
  return list;
}

// ---- Planes: points, outlines, normals, ids ----

namespace {

/// Some files contain an unused color field, with the same value for all points.
bool has_colors(std::span<const std::uint8_t> rgb) {
  for (std::size_t i = 3; i < rgb.size(); ++i)
    if (rgb[i] != rgb[i % 3]) return true;
  return false;
}

/// Voxels of each plane, by id - 1.
std::vector<std::vector<Vec3f>> voxels_by_plane(const planes::FrameResult& result) {
  std::vector<std::vector<Vec3f>> members(result.segmentation.planes.size());
  for (std::size_t i = 0; i < result.voxels.points.size(); ++i)
    if (const std::int32_t id = result.segmentation.plane_of[i]; id > 0)
      members[id - 1].push_back(result.voxels.points[i]);
  return members;
}

void add_plane_shapes(const Frame& frame,
                      const planes::FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list) {
  const float arrow_m = normal_arrow_m(result.voxels.points);
  const double cell_m = result.voxels.size_m > 0 ? result.voxels.size_m : 0.02;
  const Vec3d& origin = result.cloud.origin;
  const auto outlines = planes::outlines_of(frame, result, cell_m);
  std::vector<PlaneShape> shapes = plane_shapes(outlines, origin);
  const auto own = voxels_by_plane(result);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const planes::PlaneRegion& plane = result.segmentation.planes[k];
    const Rgba color = color_of(plane.id, color_of_plane);
    const Rgba dark = mix(color, kSceneText, 0.45);
    fill_shape(outlines[k], origin, shapes[k]);
    add_shape(shapes[k],
              {.fill = with_alpha(color, 50),
               .line = with_alpha(dark, 230),
               .width_px = 1.6F,
               .id = static_cast<std::uint32_t>(plane.id)},
              list);
    if (!is_named(plane.points, result.voxels.points.size())) continue;
    const Vec3f from = place_on_plane(plane.fit.centroid, own[k], static_cast<float>(cell_m));
    const Vec3f normal = plane.fit.normal.cast<float>();
    list.arrows.push_back({from, from + arrow_m * normal, dark, 2.5F});
    list.labels.push_back({from + 1.35F * arrow_m * normal, std::to_string(plane.id), kSceneText,
                           19, plane_label_rank(plane.points, result.voxels.points.size())});
  }
}

}  // namespace

DrawList scene_planes(const Frame& frame,
                      const planes::FrameResult& result,
                      std::span<const int> color_of_plane) {
  const std::vector<std::int32_t>& plane_of = result.segmentation.plane_of;
  DrawList list = voxel_scene(result, "Final planes", [&](std::size_t i) {
    return plane_of[i] > 0 ? color_of(plane_of[i], color_of_plane) : kSceneFaded;
  });
  for (const std::int32_t id : plane_of)
    list.points[0].ids.push_back(static_cast<std::uint32_t>(std::max(id, 0)));
  const std::size_t n = plane_of.size();
  const auto in_planes =
      static_cast<std::size_t>(std::ranges::count_if(plane_of, [](auto id) { return id > 0; }));
  add_plane_shapes(frame, result, color_of_plane, list);
  add_plane_legend(result, color_of_plane, list);
  if (in_planes < n) list.explain(kSceneFaded, "in no plane  " + std::to_string(n - in_planes));
  add_gravity(result, list);
  const std::size_t planes = result.segmentation.planes.size();
  list.subtitle =
      fmt::format("{} {} {} of {} voxels", planes,
                  planes == 1 ? "plane contains" : "planes contain", percent(in_planes, n), n);
  return list;
}

DrawList scene_overlay(const Frame& frame,
                       const planes::FrameResult& result,
                       std::span<const int> color_of_plane) {
  const bool colored = frame.cloud && has_colors(frame.cloud->rgb);
  DrawList list = cloud_scene(result.cloud, "Planes over the cloud", [&](std::size_t i) {
    Rgba base{160, 163, 168, 255};
    if (colored) {
      const std::uint8_t* rgb = &frame.cloud->rgb[std::size_t{3} * result.cloud.source[i]];
      base = {rgb[0], rgb[1], rgb[2], 255};
    }
    const std::int32_t id = result.plane_of[i];
    return id > 0 ? mix(base, color_of(id, color_of_plane), 0.6) : base;
  });
  list.subtitle = points_text(list);
  const auto own = voxels_by_plane(result);
  for (const planes::PlaneRegion& plane : result.segmentation.planes)
    if (is_named(plane.points, result.voxels.points.size()))
      list.labels.push_back({place_on_plane(plane.fit.centroid, own[plane.id - 1],
                                            static_cast<float>(result.voxels.size_m)),
                             std::to_string(plane.id), kSceneText, 19,
                             plane_label_rank(plane.points, result.voxels.points.size())});
  add_gravity(result, list);
  add_plane_legend(result, color_of_plane, list);
  return list;
}

// ---- Ground truth ----

namespace {

constexpr double kTruthTint = 0.55;
constexpr int kTitleRoom = 52, kLegendRoom = 52, kGap = 12;  // [px]
constexpr const char* kTitles[] = {"Labels", "Found", "Errors"};
constexpr std::size_t kVerdicts = 6;
constexpr std::array<const char*, kVerdicts> kNames = {"not scored", "right",       "missed",
                                                       "invented",   "wrong plane", "wrong class"};

std::array<std::size_t, kVerdicts> counts_of(const planes::EvaluatedFrame& evaluated) {
  std::array<std::size_t, kVerdicts> counts{};
  for (const planes::Verdict verdict : evaluated.verdict)
    ++counts[static_cast<std::size_t>(verdict)];
  return counts;
}

/// Color of a kind of error; faded for correct and unscored points.
Rgba error_color(planes::Verdict verdict) {
  static constexpr std::array<Rgba, kVerdicts> kErrorColors = {
      kSceneFaded, kSceneFaded, {0, 114, 178}, {230, 159, 0}, {204, 60, 130}, {0, 158, 115}};
  return kErrorColors[static_cast<std::size_t>(verdict)];
}

/// Color of a point in each of the three pictures; alpha 0: not shown.
struct PointColors {
  std::vector<Rgba> of[3];
};
PointColors point_colors(const planes::FrameResult& result,
                         const planes::EvaluatedFrame& evaluated,
                         std::span<const int> color_of_plane) {
  constexpr Rgba kNone{0, 0, 0, 0};
  const std::vector<int> true_colors =
      true_plane_colors(plane_image(result.cloud, evaluated.true_plane, evaluated.found_of.size()),
                        evaluated.found_of, color_of_plane);
  PointColors colors;
  for (std::size_t i = 0; i < evaluated.verdict.size(); ++i) {
    const std::int32_t truth = evaluated.true_plane[i], found = result.plane_of[i];
    colors.of[0].push_back(truth > 0 ? color_of(truth, true_colors) : kNone);
    colors.of[1].push_back(found > 0 ? color_of(found, color_of_plane) : kNone);
    const planes::Verdict verdict = evaluated.verdict[i];
    colors.of[2].push_back(verdict == planes::Verdict::right ? kNone : error_color(verdict));
  }
  return colors;
}

Image8 titled(const Image8& image, const std::string& title) {
  Image8 result(image.width, image.height + kTitleRoom, 3, 255);
  draw_text(result, 4, kTitleRoom - 16, title, 30, kSceneText);
  std::copy(image.data.begin(), image.data.end(),
            result.data.begin() + static_cast<std::ptrdiff_t>(3) * image.width * kTitleRoom);
  return result;
}

Image8 with_legend(const Image8& image, const planes::EvaluatedFrame& evaluated) {
  Image8 result(image.width, image.height + kLegendRoom, 3, 255);
  std::copy(image.data.begin(), image.data.end(), result.data.begin());
  const int y = image.height + 12;
  double x = 4;
  const auto counts = counts_of(evaluated);
  for (std::size_t k = 2; k < kVerdicts; ++k) {
    fill_rect(result, static_cast<int>(x), y, 26, 26, error_color(static_cast<planes::Verdict>(k)));
    x += 36;
    x += draw_text(result, x, y + 22, fmt::format("{} {}", kNames[k], counts[k]), 26, kSceneText) +
         36;
  }
  return result;
}

}  // namespace

std::string errors_text(const planes::EvaluatedFrame& evaluated) {
  const auto counts = counts_of(evaluated);
  const std::size_t scored = evaluated.verdict.size() - counts[0];
  std::string text;
  for (std::size_t k = 2; k < kVerdicts; ++k)
    if (counts[k] > 0)
      text +=
          fmt::format("{}{} {}", text.empty() ? "" : ", ", kNames[k], percent(counts[k], scored));
  return text.empty() ? "no errors" : text;
}

Image8 image_truth(const Frame& frame,
                   const planes::FrameResult& result,
                   const planes::EvaluatedFrame& evaluated,
                   std::span<const int> color_of_plane) {
  const PointColors colors = point_colors(result, evaluated, color_of_plane);
  const Image8 relief = shaded_depth(frame);
  const int factor = enlargement(relief.width);
  std::vector<Image8> panels;
  for (int k = 0; k < 3; ++k) {
    Image8 panel = relief;
    for (std::size_t i = 0; i < result.cloud.source.size(); ++i) {
      const auto pixel = static_cast<int>(result.cloud.source[i]);
      const Rgba color = colors.of[k][i];
      if (color.a > 0)
        blend_pixel(panel, pixel % panel.width, pixel / panel.width, color,
                    k < 2 ? kTruthTint : 0.85);
    }
    panels.push_back(titled(enlarge(panel, factor), kTitles[k]));
  }
  return with_legend(side_by_side(panels), evaluated);
}

std::array<DrawList, 3> scenes_truth(const planes::FrameResult& result,
                                     const planes::EvaluatedFrame& evaluated,
                                     std::span<const int> color_of_plane) {
  const PointColors colors = point_colors(result, evaluated, color_of_plane);
  std::array<DrawList, 3> scenes;
  for (int k = 0; k < 3; ++k)
    scenes[k] = cloud_scene(result.cloud, kTitles[k], [&](std::size_t i) {
      return colors.of[k][i].a > 0 ? colors.of[k][i] : kSceneFaded;
    });
  const auto counts = counts_of(evaluated);
  for (std::size_t v = 2; v < kVerdicts; ++v)
    scenes[2].explain(error_color(static_cast<planes::Verdict>(v)),
                      fmt::format("{}  {}", kNames[v], counts[v]));
  return scenes;
}

Image8 side_by_side(std::span<const Image8> images) {
  int width = -kGap, height = 0;
  for (const Image8& image : images) {
    width += image.width + kGap;
    height = std::max(height, image.height);
  }
  Image8 row(std::max(width, 0), height, 3, 255);
  int left = 0;
  for (const Image8& image : images) {
    for (int y = 0; y < image.height; ++y)
      std::copy_n(&image.at(0, y), 3 * image.width, &row.at(left, y));
    left += image.width + kGap;
  }
  return row;
}

}  // namespace planescope::render
