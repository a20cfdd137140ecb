#pragma once

// The numbers of the one objective by which `refined` finds planes: misfit over the measured noise,
// a cost for each plane, and one for each unexplained pixel or point. None depends on the camera or
// is a length: what differs between sensors is measured in the frame.

namespace planescope::planes {

struct ObjectiveOptions {
  // Of depth images (core/planes/depth) and of clouds (cloud_regions.hpp).
  double flat = 3;         // Criterion 3: largest variance of a cell, relative to the expected
  double bow = 2.5;        // the low-frequency error, in units of what it is measured by
  double merge_cost = 10;  // of a plane: regions join where their misfit costs less

  // Of depth images.
  double two_planes = 0.3;    // Criterion 1: halves of a cell part above this share of merge_cost
  double filled = 0.4;        // Criterion 2: least share of a cell's pixels that it holds
  double lateral_px = 2;      // sideways error of a pixel
  double reach_sigma = 3;     // cost of an unexplained pixel, as a residual
  double hidden_share = 0.5;  // parts that something hides join below this share of merge_cost
  double worth_px = 1000;     // least worth of a listed plane
  double undecided = 0.5;     // planes of a smaller margin are undecided

  // Of clouds; sigma is the noise measured in the cloud.
  double resolution = 0.05;        // sigma is at least this, in spacings of points
  double point_reach_sigma = 4.5;  // cost of an unexplained point, as a distance
  double label_sigma = 2;          // a plane of the other label seems this much farther off
  double plane_cost = 180;         // squared sigma: what a plane costs

  template <typename Rows>
  static void describe(Rows& rows) {
    using O = ObjectiveOptions;
    rows.number("flat", "Cell flatness", "1", "Criterion 3: largest variance of a cell, relative to the expected", &O::flat, {0, 1e6, true});
    rows.number("bow", "Bow allowed", "1", "low-frequency error of depth, relative to the measured one", &O::bow, {0, 100});
    rows.number("merge_cost", "Merge cost", "1", "cost of a plane: regions merge when their misfit costs less", &O::merge_cost, {0, 1e6});
    rows.group.images = true;
    rows.number("two_planes", "Two-plane split", "share", "depth images, Criterion 1: largest cost of one plane rather than two, as a share of merge_cost", &O::two_planes, {0, 1e6});
    rows.number("filled", "Least filled share", "share", "depth images, Criterion 2: minimum share of a cell's pixels on its plane", &O::filled, {0, 1});
    rows.number("lateral_px", "Lateral error", "px", "depth images: lateral error of a pixel", &O::lateral_px, {0, 100});
    rows.number("reach_sigma", "Cost of unexplained pixels", "sigma", "depth images: cost of an unassigned pixel, as a residual", &O::reach_sigma, {0, 100});
    rows.number("hidden_share", "Joining hidden parts", "share", "depth images: cost limit for merging parts separated by an occlusion, as a share of merge_cost", &O::hidden_share, {0, 100});
    rows.number("worth_px", "Least worth of a plane", "px", "depth images: minimum worth of a plane, in pixels of a plane with 1 % RMS (image 640 px wide)", &O::worth_px, {0, 1e9});
    rows.number("undecided", "Margin of undecided planes", "1", "depth images: planes with a smaller margin are undecided", &O::undecided, {0, 1e6});
    rows.group.images = false;
    rows.number("resolution", "Spacing noise", "spacings", "clouds: minimum noise sigma, in spacings of points", &O::resolution, {0, 100});
    rows.number("point_reach_sigma", "Cost of unexplained points", "sigma", "clouds: cost of an unassigned point, as a distance", &O::point_reach_sigma, {0, 1000});
    rows.number("label_sigma", "Label penalty", "sigma", "clouds: extra distance of a point from a plane of the other label", &O::label_sigma, {0, 1000});
    rows.number("plane_cost", "Plane cost", "sigma2", "clouds: cost of a plane", &O::plane_cost, {0, 1e9});
  }
};

}  // namespace planescope::planes
