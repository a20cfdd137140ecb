#pragma once

// Scores outlines, certainty and foot placements against synthetic truth.

#include <array>
#include <vector>

#include "core/lab/experiments/contest.hpp"

namespace planescope::lab {

/// A visible true plane: the part of it within the range of the run.
struct OutlineScore {
  double true_m2 = 0;
  int found = 0;   // id, 0: no matching plane
  double iou = 0;  // of the outline's covered area, without holes and unknown area; 0: not found
  double drawn_iou = 0;  // the same, for true planes, pixel by pixel, as input
  // Errors of the found plane in its sigmas: the two tilts, and the offset.
  std::array<double, 3> off_sigmas{};
  double range_m = 0, voxels = 0;
};
void visit_fields(auto& fields, Same<OutlineScore> auto& plane) {
  fields("true_m2", plane.true_m2);
  fields("found", plane.found);
  fields("iou", plane.iou);
  fields("drawn_iou", plane.drawn_iou);
  fields("off_sigmas", plane.off_sigmas);
  fields("range_m", plane.range_m);
  fields("voxels", plane.voxels);
}

/// Foot centers in a 2 cm grid, on planes reported as steppable.
struct FootScore {
  int steppable = 0;  // planes
  int places = 0;
  int off = 0;      // the foot's center or rim is over a hole, or more than 2 cm off any surface
  int hidden = 0;   // occluded from the camera
  int spaces = 0;   // planes with room for the foot, steppable or not
  int invalid = 0;  // of these, area invalid or a piece not convex or not inside
  double area_m2 = 0, covered_m2 = 0;  // of these, and of their pieces
  int pieces = 0;
  double least_covered = 1;  // share, of a plane
};
void visit_fields(auto& fields, Same<FootScore> auto& foot) {
  fields("steppable", foot.steppable);
  fields("places", foot.places);
  fields("off", foot.off);
  fields("hidden", foot.hidden);
  fields("spaces", foot.spaces);
  fields("invalid", foot.invalid);
  fields("area_m2", foot.area_m2);
  fields("covered_m2", foot.covered_m2);
  fields("pieces", foot.pieces);
  fields("least_covered", foot.least_covered);
}

struct OutlineFrameScore {
  std::vector<OutlineScore> planes;
  FootScore foot;
};
void visit_fields(auto& fields, Same<OutlineFrameScore> auto& frame) {
  fields("planes", frame.planes);
  fields("foot", frame.foot);
}

/// `frame`: a depth frame with exact labels and polygons.
OutlineFrameScore score_outlines(const EvaluationFrame& frame,
                                 const planes::PipelineOptions& options,
                                 const planes::Classifier* classifier);

}  // namespace planescope::lab
