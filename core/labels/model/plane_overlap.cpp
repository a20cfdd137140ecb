#include "core/labels/model/plane_overlap.hpp"

#include <algorithm>
#include <cassert>

#include "core/planes/evaluate/plane_match.hpp"

namespace planescope::labels {
namespace {

/// Places of ids in an ascending list of those that occur; -1 for the others.
struct Places {
  std::vector<int> ids, place;

  explicit Places(std::span<const std::int32_t> image) {
    const int most = image.empty() ? 0 : std::max(0, *std::max_element(image.begin(), image.end()));
    place.assign(static_cast<std::size_t>(most) + 1, -1);
  }
  void finish() {
    for (std::size_t id = 1; id < place.size(); ++id) {
      if (place[id] < 0) continue;
      place[id] = static_cast<int>(ids.size());
      ids.push_back(static_cast<int>(id));
    }
  }
};

}  // namespace

PlaneOverlap overlap_of(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
  assert(a.size() == b.size());
  Places in_a(a), in_b(b);
  const auto is_scored = [&](std::size_t i) { return a[i] >= 0 && b[i] >= 0; };
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_scored(i)) continue;
    in_a.place[a[i]] = in_b.place[b[i]] = 0;
  }
  in_a.finish();
  in_b.finish();

  PlaneOverlap overlap;
  overlap.ids_a = in_a.ids;
  overlap.ids_b = in_b.ids;
  overlap.pixels_a.assign(in_a.ids.size(), 0);
  overlap.pixels_b.assign(in_b.ids.size(), 0);
  overlap.shared.assign(in_a.ids.size() * in_b.ids.size(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_scored(i)) continue;
    ++overlap.pixels;
    const int place_a = a[i] > 0 ? in_a.place[a[i]] : -1;
    const int place_b = b[i] > 0 ? in_b.place[b[i]] : -1;
    if (place_a >= 0) ++overlap.pixels_a[place_a];
    if (place_b >= 0) ++overlap.pixels_b[place_b];
    if (place_a >= 0 && place_b >= 0) ++overlap.shared[place_a * in_b.ids.size() + place_b];
  }
  return overlap;
}

std::vector<PlanePair> matched_planes(const PlaneOverlap& overlap, double least_iou) {
  const std::size_t rows = overlap.ids_a.size(), columns = overlap.ids_b.size();
  std::vector<double> iou(rows * columns);
  for (std::size_t a = 0; a < rows; ++a) {
    for (std::size_t b = 0; b < columns; ++b) iou[a * columns + b] = overlap.iou(a, b);
  }
  const auto column =
      planes::best_assignment(iou, static_cast<int>(rows), static_cast<int>(columns));
  std::vector<PlanePair> pairs;
  for (std::size_t a = 0; a < rows; ++a) {
    if (column[a] < 0) continue;
    const auto b = static_cast<std::size_t>(column[a]);
    if (iou[a * columns + b] >= least_iou) pairs.push_back({a, b});
  }
  return pairs;
}

}  // namespace planescope::labels
