#pragma once

#include <vector>

#include "core/model/image.hpp"

namespace planescope::labels {

/// Connected parts (four neighbours) of every value in an image, by value; as long as the largest
/// value needs.
std::vector<int> count_fragments(const Image16& image);

}  // namespace planescope::labels
