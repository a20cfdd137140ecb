#pragma once

// Where labels and an algorithm, or two annotators, disagree: regions, the largest first.

#include <optional>
#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "core/labels/review/agreement.hpp"

namespace planescope::labels {

struct Disagreement {
  DisagreementKind kind = DisagreementKind::missed;
  int label_plane = 0, other_plane = 0;  // 0: none
  PixelSet pixels;                       // connected
  std::uint32_t pixel = 0;               // deepest inside
  double area_m2 = 0;
  std::optional<ReviewNote> note;  // of an earlier decision about this region
};

struct ReviewOptions {
  double min_area_m2 = 0.0005;  // smaller regions are no question
  int boundary_px = 3;          // a region nowhere thicker than this is a boundary
};

/// missed: labelled, and no plane of the other there. invented: the reverse. split: the other cuts
/// a labelled plane, this is the smaller part. merged: the other's plane runs on over another
/// labelled plane. class_flip: matched planes of different class. boundary: a thin strip of any of
/// these. Unlabelled pixels that are not ignored count as labelled "no plane". Undecided first,
/// of these boundaries last, then by area.
std::vector<Disagreement> find_disagreements(const FrameLabels& labels,
                                             const OtherLabels& other,
                                             const LabelGrid& grid,
                                             const ReviewOptions& options = {});

/// The labels after a decision, the note of it among them: `take` gives the region what the other
/// says, `ignore` marks it as not scored, `keep` and `edit` leave it.
FrameLabels decided(const FrameLabels& labels,
                    const LabelGrid& grid,
                    const Disagreement& about,
                    const OtherLabels& other,
                    ReviewDecision decision,
                    const std::string& reviewer,
                    std::int64_t time_s);

}  // namespace planescope::labels
