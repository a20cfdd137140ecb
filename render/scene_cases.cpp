// Octree nodes by case: the panels a-d of the paper's figure, on real data.

#include <algorithm>
#include <string>
#include <vector>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr std::size_t kMostNumerals = 60;

DrawBox tile_of(const planes::FrameResult& result, const planes::OctreeNode& node) {
  return points_box(result.segmentation.octree, node, result.voxels.size_m);
}

bool divided(const planes::OctreeNode& node) { return node.first_child >= 0; }

/// Numerals on the largest settled nodes, so that cases need not be told by colour alone.
void add_numerals(const planes::FrameResult& result, double least_edge_m, DrawList& list) {
  const planes::Octree& octree = result.segmentation.octree;
  std::vector<const planes::OctreeNode*> nodes;
  for (const planes::OctreeNode& node : octree.nodes)
    if (node.decided != planes::Case::none && !divided(node) &&
        octree.node_edge_m(node) >= least_edge_m)
      nodes.push_back(&node);
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const planes::OctreeNode* a, const planes::OctreeNode* b) {
                     return a->depth != b->depth ? a->depth < b->depth : a->size() > b->size();
                   });
  if (nodes.size() > kMostNumerals) nodes.resize(kMostNumerals);
  for (const planes::OctreeNode* node : nodes) {
    const DrawBox box = tile_of(result, *node);
    list.labels.push_back(
        {(box.min + box.max) / 2,
         std::string(planes::to_string(node->decided)) + (node->impure_fit ? "*" : ""), kSceneText,
         15, true});
  }
}

}  // namespace

DrawList scene_cases(const planes::FrameResult& result) {
  using Mark = LegendEntry::Mark;
  const planes::Octree& octree = result.segmentation.octree;
  DrawList list;
  std::size_t count[5] = {}, hatched = 0, label_fits = 0;
  DrawPoints points = voxel_points(result.voxels);
  points.colors.assign(points.positions.size(), case_color(planes::Case::none));
  DrawPoints fitted;  // marks of nodes that R4 fitted label by label
  fitted.size_m = 0;
  fitted.min_px = 6;
  const double numeral_edge_m = 0.05 * robust_bounds(result.voxels.points).diagonal();
  for (const planes::OctreeNode& node : octree.nodes) {
    if (node.decided == planes::Case::none) continue;
    ++count[static_cast<int>(node.decided)];
    DrawBox box = divided(node) ? cell_box(octree, node) : tile_of(result, node);
    box.color = case_color(node.decided);
    if (divided(node)) {
      box.color.a = 40;  // the finer nodes inside are what matters
    } else {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        points.colors[octree.order[i]] = box.color;
      if (node.at_max_depth) {
        box.style = BoxStyle::hatched;
        ++hatched;
      }
      if (node.impure_fit) {
        ++label_fits;
        if (octree.node_edge_m(node) < numeral_edge_m)  // larger ones get a numeral with a star
          fitted.positions.push_back((box.min + box.max) / 2);
      }
    }
    list.boxes.push_back(box);
  }
  list.points.push_back(std::move(points));
  add_numerals(result, numeral_edge_m, list);

  list.title = "Octree nodes by case";
  list.subtitle = std::to_string(result.segmentation.counts.nodes_visited) +
                  " nodes visited; voxels in the colour of the node that settled them";
  add_case_legend(count, list);
  if (hatched > 0)
    list.legend.push_back({Mark::hatched_box, case_color(planes::Case::III),
                           "I or III at full depth: left over  " + std::to_string(hatched)});
  if (label_fits > 0)
    list.legend.push_back({Mark::dot, kSceneText,
                           "or I*: fitted label by label (R4)  " + std::to_string(label_fits)});
  fitted.colors.assign(fitted.positions.size(), kSceneText);
  list.points.push_back(std::move(fitted));
  add_gravity(result, list);
  return list;
}

}  // namespace planescope::render
