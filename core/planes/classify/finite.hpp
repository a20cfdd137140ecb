#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

/// What `classify(points)` says of the finite points, as if there were no others; these are
/// `unknown`, with margin 0.
template <typename Classify>
Classification classify_finite(std::span<const Vec3f> points, const Classify& classify) {
  const auto finite = [](const Vec3f& p) { return p.allFinite(); };
  if (std::all_of(points.begin(), points.end(), finite)) return classify(points);
  std::vector<Vec3f> kept;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kept), finite);
  const Classification of_kept = classify(std::span<const Vec3f>(kept));
  Classification result;
  result.labels.assign(points.size(), Label::unknown);
  result.margins.assign(points.size(), 0.0f);
  for (std::size_t i = 0, k = 0; i < points.size(); ++i) {
    if (!finite(points[i])) continue;
    result.labels[i] = of_kept.labels[k];
    result.margins[i] = of_kept.margins[k++];
  }
  return result;
}

}  // namespace planescope::planes
