// Octree nodes by case: the panels a-d of the paper's figure, on real data.

#include <algorithm>
#include <string>
#include <vector>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope {
namespace {

constexpr std::size_t kMostNumerals = 60;

DrawBox box_of(const Octree& octree, const OctreeNode& node) {
  const Vec3d low = octree.node_min(node);
  DrawBox box;
  box.min = low.cast<float>();
  box.max = (low + Vec3d::Constant(octree.node_edge_m(node))).cast<float>();
  box.color = case_color(node.decided);
  return box;
}

bool divided(const OctreeNode& node) { return node.first_child >= 0; }

/// Numerals on the largest settled nodes, so that cases need not be told by colour alone.
void add_numerals(const Octree& octree, double least_edge_m, DrawList& list) {
  std::vector<const OctreeNode*> nodes;
  for (const OctreeNode& node : octree.nodes)
    if (node.decided != Case::none && !divided(node) && octree.node_edge_m(node) >= least_edge_m)
      nodes.push_back(&node);
  std::stable_sort(nodes.begin(), nodes.end(), [](const OctreeNode* a, const OctreeNode* b) {
    return a->depth != b->depth ? a->depth < b->depth : a->size() > b->size();
  });
  if (nodes.size() > kMostNumerals) nodes.resize(kMostNumerals);
  for (const OctreeNode* node : nodes) {
    const Vec3d center = octree.node_min(*node) + Vec3d::Constant(octree.node_edge_m(*node) / 2);
    list.labels.push_back({center.cast<float>(), to_string(node->decided), kSceneText, 13, true});
  }
}

}  // namespace

DrawList scene_cases(const FrameResult& result) {
  using Mark = LegendEntry::Mark;
  const Octree& octree = result.segmentation.octree;
  DrawList list;
  std::size_t count[5] = {}, hatched = 0;
  DrawPoints fitted;  // marks of nodes that R4 fitted label by label
  fitted.size_m = 0;
  fitted.min_px = 4;
  for (const OctreeNode& node : octree.nodes) {
    if (node.decided == Case::none) continue;
    ++count[static_cast<int>(node.decided)];
    DrawBox box = box_of(octree, node);
    if (divided(node)) {
      box.style = BoxStyle::outline;
      box.color.a = 70;  // the finer nodes inside are what matters
    } else if (node.at_max_depth) {
      box.style = BoxStyle::hatched;
      ++hatched;
    } else {
      box.style = BoxStyle::tinted;
    }
    if (node.impure_fit) fitted.positions.push_back((box.min + box.max) / 2);
    list.boxes.push_back(box);
  }
  add_numerals(octree, 0.04 * robust_bounds(result.voxels.points).diagonal(), list);

  list.title = "Octree nodes by case";
  list.subtitle = std::to_string(result.segmentation.counts.nodes_visited) + " nodes visited";
  const auto entry = [&](Case c, const std::string& meaning) {
    list.legend.push_back({Mark::box, case_color(c),
                           std::string(to_string(c)) + "  " + meaning + "  " +
                               std::to_string(count[static_cast<int>(c)])});
  };
  entry(Case::I, "impure: divided");
  entry(Case::II, "too few points: left over");
  entry(Case::III, "not planar: divided");
  entry(Case::IV, "plane candidate");
  if (hatched > 0)
    list.legend.push_back({Mark::hatched_box, case_color(Case::III),
                           "of I and III, at full depth: left over  " + std::to_string(hatched)});
  if (!fitted.positions.empty()) {
    list.legend.push_back(
        {Mark::dot, kSceneText,
         "of I, fitted label by label (R4)  " + std::to_string(fitted.positions.size())});
    fitted.colors.assign(fitted.positions.size(), kSceneText);
    list.points.push_back(std::move(fitted));
  }
  add_gravity(result, list);
  return list;
}

}  // namespace planescope
