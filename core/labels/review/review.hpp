#pragma once

// Agreement between two labelings of the same pixels, and the regions where labels and an
// algorithm, or two annotators, disagree, the largest first.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// Labels to compare with, on the same pixels.
struct OtherLabels {
  std::vector<std::int32_t> plane;  // per pixel, 0 none, -1 unknown (cropped, ignored)
  std::vector<Label> label;         // of a plane, by id - 1
};
OtherLabels other_of(const FrameLabels& labels);

struct PlaneOverlap {
  std::vector<int> ids_a, ids_b;           // of planes with scored pixels, ascending
  std::vector<double> pixels_a, pixels_b;  // of each
  std::vector<double> shared;              // row-major, a x b
  std::size_t pixels = 0;                  // scored

  double at(std::size_t a, std::size_t b) const { return shared[a * ids_b.size() + b]; }
  double iou(std::size_t a, std::size_t b) const {
    return at(a, b) / (pixels_a[a] + pixels_b[b] - at(a, b));
  }
};

/// Ids > 0 are planes, 0 is none; pixels with a negative id in either are not scored.
PlaneOverlap overlap_of(std::span<const std::int32_t> a, std::span<const std::int32_t> b);

/// Planes matched one to one for the greatest total IoU, among pairs with at least `least_iou`.
struct PlanePair {
  std::size_t a = 0, b = 0;  // indices in the overlap's lists
};
std::vector<PlanePair> matched_planes(const PlaneOverlap& overlap, double least_iou);

/// Agreement of two labelings of the same pixels.
struct Agreement {
  double mean_iou = 0;         // of planes matched one to one, over all planes of both
  double adjusted_rand = 0;    // over pixels with a plane in both
  double label_accuracy = 0;   // same h/v, of pixels with a class in both
  double pixel_agreement = 0;  // of pixels labeled by either: same matched plane
  int planes_a = 0, planes_b = 0, matched = 0;  // matched: IoU of at least 0.5
  std::size_t pixels = 0;                       // scored: ignored by neither
};
Agreement agreement_of(const FrameLabels& a, const FrameLabels& b);

struct Disagreement {
  DisagreementKind kind = DisagreementKind::missed;
  int label_plane = 0, other_plane = 0;  // 0: none
  PixelSet pixels;                       // connected
  std::uint32_t pixel = 0;               // deepest inside
  double area_m2 = 0;
  std::optional<ReviewNote> note;  // of an earlier decision about this region
};

struct ReviewOptions {
  double min_area_m2 = 0.0005;  // ignore smaller regions
  int boundary_px = 3;          // a region nowhere thicker than this is a boundary
};

/// missed: labeled, but without a plane in the other. invented: the reverse. split: the other
/// splits a labeled plane, and this is the smaller part. merged: the other's plane continues on
/// another labeled plane. class_flip: matched planes of different class. boundary: a thin strip of
/// any of these. Unlabeled pixels that are not ignored count as labeled "no plane". Ordered by
/// undecided first, among these boundaries last, then by area.
std::vector<Disagreement> find_disagreements(const FrameLabels& labels,
                                             const OtherLabels& other,
                                             const LabelGrid& grid,
                                             const ReviewOptions& options = {});

/// Adds the note of a decision. `take` copies the other's labels to the region, `ignore` excludes
/// it from scoring, `keep` and `edit` do not change it. Throws Error, before anything changes, if
/// the region belongs to locked or hidden planes.
void decide(LabelDraft& draft,
            const LabelGrid& grid,
            const Disagreement& about,
            const OtherLabels& other,
            ReviewDecision decision,
            const std::string& reviewer,
            std::int64_t time_s);

}  // namespace planescope::labels
