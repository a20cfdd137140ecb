#include "core/labels/review/agreement.hpp"

#include <algorithm>
#include <cassert>

#include "core/planes/evaluate/metrics.hpp"

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

constexpr double kLeastIou = 0.5;

double pairs_of(double n) { return n * (n - 1) / 2; }

/// Hubert and Arabie 1985: 1 the same partition, 0 as much alike as two random ones.
double adjusted_rand_index(const PlaneOverlap& overlap) {
  const std::size_t rows = overlap.ids_a.size(), columns = overlap.ids_b.size();
  std::vector<double> sum_a(rows, 0), sum_b(columns, 0);
  double both = 0, in_a = 0, in_b = 0, pixels = 0;
  for (std::size_t a = 0; a < rows; ++a) {
    for (std::size_t b = 0; b < columns; ++b) {
      sum_a[a] += overlap.at(a, b);
      sum_b[b] += overlap.at(a, b);
      both += pairs_of(overlap.at(a, b));
    }
    in_a += pairs_of(sum_a[a]);
    pixels += sum_a[a];
  }
  for (const double sum : sum_b) in_b += pairs_of(sum);
  const double expected = pixels > 1 ? in_a * in_b / pairs_of(pixels) : 0;
  const double most = (in_a + in_b) / 2;
  return most == expected ? 1 : (both - expected) / (most - expected);
}

double share(double part, double whole) { return whole > 0 ? part / whole : 1; }

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

OtherLabels other_of(const FrameLabels& labels) {
  OtherLabels other;
  for (const std::uint16_t id : labels.plane.data) {
    other.plane.push_back(id == kPlaneIgnore ? -1 : id);
  }
  for (const LabelPlane& plane : labels.planes) {
    const auto size = std::max(other.label.size(), static_cast<std::size_t>(plane.id));
    other.label.resize(size, Label::unknown);
    other.label[plane.id - 1] = plane.label;
  }
  return other;
}

Agreement agreement_of(const FrameLabels& a, const FrameLabels& b) {
  const OtherLabels in_a = other_of(a), in_b = other_of(b);
  const PlaneOverlap overlap = overlap_of(in_a.plane, in_b.plane);
  const auto pairs = matched_planes(overlap, kLeastIou);

  Agreement agreement;
  agreement.planes_a = static_cast<int>(overlap.ids_a.size());
  agreement.planes_b = static_cast<int>(overlap.ids_b.size());
  agreement.matched = static_cast<int>(pairs.size());
  agreement.pixels = overlap.pixels;
  double iou = 0, same = 0, labelled = 0;
  for (const double pixels : overlap.pixels_a) labelled += pixels;
  for (const double pixels : overlap.pixels_b) labelled += pixels;
  for (const double pixels : overlap.shared) labelled -= pixels;
  for (const PlanePair& pair : pairs) {
    iou += overlap.iou(pair.a, pair.b);
    same += overlap.at(pair.a, pair.b);
  }
  agreement.mean_iou = share(iou, agreement.planes_a + agreement.planes_b - agreement.matched);
  agreement.pixel_agreement = share(same, labelled);
  agreement.adjusted_rand = adjusted_rand_index(overlap);

  double both = 0, right = 0;
  for (std::size_t i = 0; i < a.hv.data.size(); ++i) {
    const auto known = [](std::uint8_t hv) { return hv == 1 || hv == 2; };
    if (!known(a.hv.data[i]) || !known(b.hv.data[i])) continue;
    ++both;
    if (a.hv.data[i] == b.hv.data[i]) ++right;
  }
  agreement.label_accuracy = share(right, both);
  return agreement;
}

}  // namespace planescope::labels
