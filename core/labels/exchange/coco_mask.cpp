#include "core/labels/exchange/coco_mask.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"

namespace planescope::labels {

std::vector<std::uint64_t> mask_counts(const std::vector<std::uint64_t>& sorted,
                                       std::uint64_t pixels) {
  std::vector<std::uint64_t> counts;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i + 1;
    while (end < sorted.size() && sorted[end] == sorted[end - 1] + 1) ++end;
    counts.push_back(sorted[i] - at);
    counts.push_back(end - i);
    at = sorted[end - 1] + 1;
    i = end;
  }
  counts.push_back(pixels - at);
  return counts;
}

std::vector<MaskRun> mask_runs(const std::vector<std::uint64_t>& counts,
                               std::uint64_t pixels,
                               const std::string& where) {
  std::vector<MaskRun> runs;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > pixels - at)
      throw Error(where + ": its mask runs past the " + std::to_string(pixels) +
                  " pixels of the image");
    if (i % 2 == 1 && counts[i] > 0) runs.push_back({at, counts[i]});
    at += counts[i];
  }
  if (at != pixels)
    throw Error(where + ": its mask covers " + std::to_string(at) + " pixels, the image has " +
                std::to_string(pixels));
  return runs;
}

// As rleFrString of pycocotools: groups of five bits, the lowest first, 48 added; from the fourth
// on counts are differences to the one before the last.
std::vector<std::uint64_t> counts_of_text(const std::string& text, const std::string& where) {
  std::vector<std::uint64_t> counts;
  for (std::size_t i = 0; i < text.size();) {
    std::int64_t value = 0;
    int shift = 0;
    bool more = true;
    while (more) {
      const int code = i < text.size() ? text[i] - 48 : -1;
      if (code < 0 || code > 63 || shift > 40)
        throw Error(where + ": its compressed mask is damaged at character " + std::to_string(i));
      value |= static_cast<std::int64_t>(code & 31) << shift;
      more = (code & 32) != 0;
      shift += 5;
      ++i;
      if (!more && (code & 16) != 0) value -= std::int64_t{1} << shift;
    }
    if (counts.size() > 2) value += static_cast<std::int64_t>(counts[counts.size() - 2]);
    if (value < 0)
      throw Error(where + ": its compressed mask has a run of " + std::to_string(value) +
                  " pixels");
    counts.push_back(static_cast<std::uint64_t>(value));
  }
  return counts;
}

std::vector<MaskRun> polygon_runs(const std::vector<std::pair<double, double>>& corners,
                                  int width,
                                  int height) {
  std::vector<MaskRun> runs;
  std::vector<double> crossings;
  for (int u = 0; u < width; ++u) {
    const double x = u + 0.5;
    crossings.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto& [ax, ay] = corners[i];
      const auto& [bx, by] = corners[(i + 1) % corners.size()];
      if ((ax <= x) != (bx <= x)) crossings.push_back(ay + (x - ax) / (bx - ax) * (by - ay));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const auto row = [&](double y) {
        return static_cast<int>(std::clamp(std::ceil(y - 0.5), 0.0, static_cast<double>(height)));
      };
      const int first = row(crossings[i]), end = row(crossings[i + 1]);
      if (first < end)
        runs.push_back({static_cast<std::uint64_t>(u) * static_cast<std::uint64_t>(height) +
                            static_cast<std::uint64_t>(first),
                        static_cast<std::uint64_t>(end - first)});
    }
  }
  return runs;
}

}  // namespace planescope::labels
