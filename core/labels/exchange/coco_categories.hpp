#pragma once

// What our COCO files call the classes, and how large their images may be. Internal to core/labels.

#include "core/labels/model/label_files.hpp"

namespace planescope::labels {

inline constexpr int kMaxCocoSide = 1 << 16;  // of an image [px]

struct CocoCategory {
  int id;
  const char* name;
  std::uint8_t label;
};
inline constexpr CocoCategory kCocoCategories[] = {
    {1, "h", 1}, {2, "v", 2}, {3, "unknown", 0}, {4, "ignore", kHvIgnore}};

}  // namespace planescope::labels
