#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

Classification classify_about_origin(const Classifier& classifier,
                                     std::span<const Vec3d> points,
                                     int threads) {
  Bounds bounds;
  for (const Vec3d& p : points)
    if (p.allFinite()) bounds.add(p);
  std::vector<Vec3f> local;
  local.reserve(points.size());
  for (const Vec3d& p : points) local.push_back((p - bounds.min).cast<float>());
  return classifier.classify(local, threads);
}

}  // namespace planescope::planes
