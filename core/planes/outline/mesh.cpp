#include "core/planes/outline/mesh.hpp"

#include <map>
#include <utility>

namespace planescope::planes {

Mesh mesh_of(const Outline& outline) {
  Mesh mesh;
  if (outline.parts.empty()) return mesh;
  std::map<std::pair<double, double>, int> numbers;
  for (const Triangle& triangle : triangulated(polygons_of(outline))) {
    std::array<int, 3>& corners = mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [at, is_new] = numbers.try_emplace({triangle[i].x(), triangle[i].y()},
                                                    static_cast<int>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(outline.world(triangle[i]));
      corners[i] = at->second;
    }
  }
  return mesh;
}

}  // namespace planescope::planes
