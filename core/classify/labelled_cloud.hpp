#pragma once

#include <string>
#include <vector>

#include "core/classify/classifier.hpp"
#include "core/geometry/types.hpp"

namespace planescope {

/// Points and their true labels: what a classifier learns from and is judged by.
struct LabelledCloud {
  std::string kind;           // where it came from: "stairs", "scan", ...
  std::vector<Vec3f> points;  // z up, metres, about a local origin
  std::vector<Label> labels;
};

}  // namespace planescope
