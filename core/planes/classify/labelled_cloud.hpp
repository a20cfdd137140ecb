#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

/// Points and their true labels: what a classifier learns from and is judged by.
struct LabelledCloud {
  std::string kind;           // where it came from: "stairs", "scan", ...
  std::vector<Vec3f> points;  // z up, metres, about a local origin
  std::vector<Label> labels;
  std::vector<std::uint8_t> near_edge = {};  // 1: within 2 cm of the other label's surface, or a
                                             // measured pixel of it;
                                             // empty where the surfaces are not known
};

}  // namespace planescope::planes
