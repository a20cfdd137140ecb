// Measures the agreement of two labelings, and finds the regions where they disagree.

#include "core/labels/review/review.hpp"

#include <algorithm>
#include <cassert>

#include "core/labels/edit/operations.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/model/error.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::labels {
namespace {

/// Index of each id in an ascending list of the existing ids; -1 for others.
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

/// Hubert and Arabie 1985: 1 for equal partitions, 0 for the agreement of two random ones.
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
  for (const std::uint16_t id : labels.plane.data)
    other.plane.push_back(id == kPlaneIgnore ? -1 : id);
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
  double iou = 0, same = 0, labeled = 0;
  for (const double pixels : overlap.pixels_a) labeled += pixels;
  for (const double pixels : overlap.pixels_b) labeled += pixels;
  for (const double pixels : overlap.shared) labeled -= pixels;
  for (const PlanePair& pair : pairs) {
    iou += overlap.iou(pair.a, pair.b);
    same += overlap.at(pair.a, pair.b);
  }
  agreement.mean_iou = share(iou, agreement.planes_a + agreement.planes_b - agreement.matched);
  agreement.pixel_agreement = share(same, labeled);
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

// Regions where two labelings disagree in the same way.

namespace {

/// Connected pixels (eight neighbors) with the same pair of planes.
struct PairRegions {
  std::vector<int> of_pixel;      // -1 none
  std::vector<PixelSet> pixels;   // of each region
  std::vector<int> thickness_px;  // edge of the largest square inside
  std::vector<std::uint32_t> deepest;
};

/// The same for a cloud's regions.
void measure_depth(PairRegions& regions, const LabelGrid& cloud) {
  const std::size_t count = regions.pixels.size();
  regions.thickness_px.assign(count, 0);
  regions.deepest.assign(count, 0);
  const std::vector<int> steps = steps_to_outside(cloud, regions.of_pixel);
  for (std::size_t k = 0; k < count; ++k) {
    const PixelSet& pixels = regions.pixels[k];
    const auto deepest =
        std::ranges::max_element(pixels, {}, [&](std::uint32_t i) { return steps[i]; });
    regions.deepest[k] = *deepest;
    // A point at the border may be up to one step away from the outside, on both sides.
    regions.thickness_px[k] = 2 * kSpacingsOfStep * steps[*deepest] - 1;
  }
}

/// Thickness and deepest pixel of all regions at once, in one pass down and one up.
void measure_depth(PairRegions& regions, int width) {
  const std::size_t count = regions.pixels.size(), pixels = regions.of_pixel.size();
  regions.thickness_px.assign(count, 0);
  regions.deepest.assign(count, 0);
  std::vector<int> square(pixels, 0), steps(pixels, 0), most(count, 0);
  const auto value = [&](const std::vector<int>& of, std::size_t pixel, int dx, int dy) {
    const int x = static_cast<int>(pixel) % width + dx, y = static_cast<int>(pixel) / width + dy;
    if (x < 0 || x >= width || y < 0 || static_cast<std::size_t>(y) * width >= pixels) return 0;
    const std::size_t there = static_cast<std::size_t>(y) * width + x;
    return regions.of_pixel[there] == regions.of_pixel[pixel] ? of[there] : 0;
  };
  for (std::size_t i = 0; i < pixels; ++i) {
    const int region = regions.of_pixel[i];
    if (region < 0) continue;
    const int left = value(square, i, -1, 0), up = value(square, i, 0, -1);
    square[i] = 1 + std::min({left, up, value(square, i, -1, -1)});
    steps[i] = 1 + std::min(value(steps, i, -1, 0), value(steps, i, 0, -1));
    regions.thickness_px[region] = std::max(regions.thickness_px[region], square[i]);
  }
  for (std::size_t i = pixels; i-- > 0;) {
    const int region = regions.of_pixel[i];
    if (region < 0) continue;
    steps[i] = 1 + std::min({steps[i] - 1, value(steps, i, 1, 0), value(steps, i, 0, 1)});
    if (steps[i] < most[region]) continue;
    most[region] = steps[i];
    regions.deepest[region] = static_cast<std::uint32_t>(i);
  }
}

/// `pairs`: per pixel a number for the pair of planes that disagree there, 0 for none.
PairRegions regions_of_pairs(const std::vector<std::uint64_t>& pairs, const LabelGrid& grid) {
  PixelSet disagreeing;
  for (std::uint32_t i = 0; i < pairs.size(); ++i)
    if (pairs[i] != 0) disagreeing.push_back(i);
  PairRegions regions;
  regions.pixels =
      flooded_parts(disagreeing, grid, regions.of_pixel,
                    [&](std::uint32_t from, std::uint32_t to) { return pairs[from] == pairs[to]; });
  grid.is_cloud() ? measure_depth(regions, grid) : measure_depth(regions, grid.width);
  return regions;
}

/// Compared value of each pixel: plane of the labels, 0 for none, or negative to skip it.
std::vector<std::int32_t> compared_planes(const FrameLabels& labels, const LabelGrid& grid) {
  std::vector<std::int32_t> planes = other_of(labels).plane;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!grid.measured[i]) planes[i] = -1;
  }
  return planes;
}

/// Matching planes of the two labelings, by id; 0: none.
struct Partners {
  std::vector<int> of_label, of_other;  // matched one to one
  std::vector<int> home_of_other;       // the labeled plane that contains most of it

  Partners(std::span<const std::int32_t> labels, const OtherLabels& other) {
    const auto size = [](std::span<const std::int32_t> planes) {
      return planes.empty() ? 1 : std::max(0, *std::max_element(planes.begin(), planes.end())) + 1;
    };
    of_label.assign(size(labels), 0);
    of_other.assign(size(other.plane), 0);
    home_of_other = of_other;
    const PlaneOverlap overlap = overlap_of(labels, other.plane);
    for (const PlanePair& pair : matched_planes(overlap, 0)) {
      of_label[overlap.ids_a[pair.a]] = overlap.ids_b[pair.b];
      of_other[overlap.ids_b[pair.b]] = overlap.ids_a[pair.a];
    }
    for (std::size_t b = 0; b < overlap.ids_b.size(); ++b) {
      double most = 0;
      for (std::size_t a = 0; a < overlap.ids_a.size(); ++a) {
        if (overlap.at(a, b) <= most) continue;
        most = overlap.at(a, b);
        home_of_other[overlap.ids_b[b]] = overlap.ids_a[a];
      }
    }
  }
};

Label class_of(const OtherLabels& other, int plane) {
  const auto place = static_cast<std::size_t>(plane) - 1;
  return plane > 0 && place < other.label.size() ? other.label[place] : Label::unknown;
}

/// Whether both planes have a class and the classes differ.
bool differ(Label a, Label b) { return a != b && a != Label::unknown && b != Label::unknown; }

DisagreementKind kind_of(int label, int other, const Partners& partners) {
  if (other == 0) return DisagreementKind::missed;
  if (label == 0) return DisagreementKind::invented;
  if (partners.of_label[label] == other) return DisagreementKind::class_flip;
  return partners.home_of_other[other] == label ? DisagreementKind::split
                                                : DisagreementKind::merged;
}

/// A pair of planes that disagree, as one number; 0 if they agree.
std::uint64_t pair_key(int label, int other) {
  return static_cast<std::uint64_t>(label) << 32u | static_cast<std::uint32_t>(other);
}

std::vector<std::uint64_t> disagreeing_pairs(std::span<const std::int32_t> planes,
                                             const FrameLabels& labels,
                                             const OtherLabels& other,
                                             const Partners& partners) {
  std::vector<std::uint8_t> flips(partners.of_label.size(), 0);
  for (const LabelPlane& plane : labels.planes) {
    const auto id = static_cast<std::size_t>(plane.id);
    if (id >= flips.size()) continue;
    flips[id] = differ(plane.label, class_of(other, partners.of_label[id])) ? 1 : 0;
  }
  std::vector<std::uint64_t> pairs(planes.size(), 0);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const int a = planes[i], b = other.plane[i];
    if (a < 0 || b < 0) continue;
    const bool same = a == 0 ? b == 0 : partners.of_label[a] == b && b != 0 && !flips[a];
    if (!same) pairs[i] = pair_key(a, b);
  }
  return pairs;
}

/// The latest decision about a region of this kind at this position and of similar size.
std::optional<ReviewNote> note_about(const Disagreement& region,
                                     const std::vector<ReviewNote>& notes) {
  const auto size = static_cast<double>(region.pixels.size());
  const auto is_about = [&](const ReviewNote& note) {
    if (note.kind != region.kind || note.pixels > 2 * size || size > 2.0 * note.pixels)
      return false;
    return std::binary_search(region.pixels.begin(), region.pixels.end(), note.pixel);
  };
  const auto latest = std::find_if(notes.rbegin(), notes.rend(), is_about);
  if (latest == notes.rend()) return std::nullopt;
  return *latest;
}

}  // namespace

std::vector<Disagreement> find_disagreements(const FrameLabels& labels,
                                             const OtherLabels& other,
                                             const LabelGrid& grid,
                                             const ReviewOptions& options) {
  assert(labels.plane.pixels() == grid.pixels() && other.plane.size() == grid.pixels());
  const auto planes = compared_planes(labels, grid);
  const Partners partners(planes, other);
  PairRegions regions = regions_of_pairs(disagreeing_pairs(planes, labels, other, partners), grid);

  std::vector<Disagreement> found;
  for (std::size_t i = 0; i < regions.pixels.size(); ++i) {
    Disagreement region;
    region.label_plane = planes[regions.pixels[i].front()];
    region.other_plane = other.plane[regions.pixels[i].front()];
    const LabelPlane* plane = find_plane(labels, region.label_plane);
    region.area_m2 = grid.area_m2(regions.pixels[i], plane ? &plane->normal : nullptr);
    if (region.area_m2 < options.min_area_m2) continue;
    region.kind = regions.thickness_px[i] <= options.boundary_px
                      ? DisagreementKind::boundary
                      : kind_of(region.label_plane, region.other_plane, partners);
    region.pixels = std::move(regions.pixels[i]);
    region.pixel = regions.deepest[i];
    region.note = note_about(region, labels.review);
    found.push_back(std::move(region));
  }
  std::stable_sort(found.begin(), found.end(), [](const Disagreement& a, const Disagreement& b) {
    if (a.note.has_value() != b.note.has_value()) return b.note.has_value();
    const bool a_thin = a.kind == DisagreementKind::boundary && !a.note;
    const bool b_thin = b.kind == DisagreementKind::boundary && !b.note;
    if (a_thin != b_thin) return b_thin;
    return a.area_m2 > b.area_m2;
  });
  return found;
}

namespace {

void paint_there(LabelDraft& draft,
                 const LabelGrid& grid,
                 const Disagreement& about,
                 const Paint& what) {
  if (paint(draft, grid, about.pixels, what, PaintMode::over) == 0)
    throw Error("the region belongs to planes that are locked or hidden");
  fit_planes(draft, grid);
}

/// Copies the region from the other labels: to the plane that matches the other's, or to a new one.
void take_other(LabelDraft& draft,
                const LabelGrid& grid,
                const Disagreement& about,
                const OtherLabels& other) {
  const int other_plane = about.other_plane;
  const Partners partners(compared_planes(draft.labels, grid), other);
  Paint paint;
  paint.origin = LabelOrigin::algorithm;
  if (other_plane > 0) {
    paint.plane = partners.of_other[other_plane];
    paint.label = class_of(other, other_plane);
    if (paint.plane > 0 && paint.plane == about.label_plane)
      return set_class(draft, paint.plane, paint.label);
    if (paint.plane == 0) paint.plane = free_plane_id(draft.labels);
  }
  paint_there(draft, grid, about, paint);
}

}  // namespace

void decide(LabelDraft& draft,
            const LabelGrid& grid,
            const Disagreement& about,
            const OtherLabels& other,
            ReviewDecision decision,
            const std::string& reviewer,
            std::int64_t time_s) {
  if (decision == ReviewDecision::take) take_other(draft, grid, about, other);
  if (decision == ReviewDecision::ignore) paint_there(draft, grid, about, {.plane = kPlaneIgnore});
  std::vector<ReviewNote>& notes = draft.labels.review;
  if (about.note) std::erase(notes, *about.note);
  notes.push_back({about.kind, about.pixel, static_cast<std::uint32_t>(about.pixels.size()),
                   about.label_plane, about.other_plane, decision, reviewer, time_s});
}

}  // namespace planescope::labels
