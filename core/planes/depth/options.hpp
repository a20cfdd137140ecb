#pragma once

// The numbers of the method for depth images: all in pixels, in 1/m, or dimensionless. None depends
// on the camera: what differs between sensors is measured in the frame (depth/noise.hpp).

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes {

struct ObjectiveOptions {
  bool on = false;  // depth images: planes by one objective, in inverse depth

  double two_planes = 0.3;    // Criterion 1: halves of a cell part above this share of merge_cost
  double filled = 0.4;        // Criterion 2: least share of a cell's pixels that it holds
  double flat = 2;            // Criterion 3: largest variance of a cell, relative to the expected
  double bow = 2.5;           // the low-frequency error, relative to what wide squares have more
  double lateral_px = 2;      // sideways error of a pixel
  double merge_cost = 10;     // of a plane: regions join where their misfit costs less
  double reach_sigma = 3;     // cost of an unexplained pixel, as a residual
  double hidden_share = 0.5;  // parts that something hides join below this share of merge_cost
  double worth_px = 7000;     // least worth of a listed plane: pixels at 1 % relative RMS, in an
                              // image 640 px wide
  double undecided = 1.5;     // a plane whose margin is below this is undecided

  template <typename Rows>
  static void describe(Rows& rows) {
    rows.flag("objective", "depth images: find planes by one objective, in inverse depth",
              &ObjectiveOptions::on);
    rows.only_with("objective");
    rows.number("two_planes", "share",
                "Criterion 1: halves of a cell are two planes above this share of merge_cost",
                &ObjectiveOptions::two_planes, {0, 1e6});
    rows.number("filled", "share", "Criterion 2: least share of a cell's pixels that it holds",
                &ObjectiveOptions::filled, {0, 1});
    rows.number("flat", "1", "Criterion 3: largest variance of a cell, relative to the expected",
                &ObjectiveOptions::flat, {0, 1e6, true});
    rows.number("bow", "1",
                "low-frequency depth error, relative to the excess noise of wide squares",
                &ObjectiveOptions::bow, {0, 100});
    rows.number("lateral_px", "px", "sideways error of a pixel", &ObjectiveOptions::lateral_px,
                {0, 100});
    rows.number("merge_cost", "1", "cost of a plane: regions join where their misfit costs less",
                &ObjectiveOptions::merge_cost, {0, 1e6});
    rows.number("reach_sigma", "sigma",
                "cost of an unexplained pixel: largest residual of a plane's pixel",
                &ObjectiveOptions::reach_sigma, {0, 100});
    rows.number("hidden_share", "share",
                "parts hidden from each other join below this share of merge_cost",
                &ObjectiveOptions::hidden_share, {0, 100});
    rows.number("worth_px", "px", "least worth of a listed plane: pixels at 1 % relative RMS",
                &ObjectiveOptions::worth_px, {0, 1e9});
    rows.number("undecided", "1", "planes with a smaller margin are undecided",
                &ObjectiveOptions::undecided, {0, 1e6});
  }
};

}  // namespace planescope::planes
