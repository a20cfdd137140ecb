#pragma once

// Results by hand: figures that are easily told apart.

#include "core/lab/experiments/paper_plan.hpp"

namespace planescope::lab {

inline Cell made_up_cell(const CellKey& key, double alpha_deg, double r_p = 100, double iou = 98) {
  Cell cell{key, 10, {}};
  cell.metrics.planes_truth = 100;
  cell.metrics.planes_found = static_cast<int>(r_p);
  cell.metrics.alpha_deg = alpha_deg;
  cell.metrics.r_p = r_p;
  cell.metrics.r_m = 0.01;
  cell.metrics.mean_iou = iou;
  cell.metrics.pq = 95.5;
  cell.metrics.detected_iou80 = 90;
  cell.metrics.points = 81920;
  return cell;
}

/// The noise table's cells with labels by gcn, whose alpha is the noise in cm.
inline PaperResults made_up_results() {
  PaperResults results;
  results.command = "planescope-lab bench paper --seed 1";
  results.build = {"0.1.0", "c0ffee", false};
  results.weights = {"classifier.safetensors", "5ha", "compact", ""};
  for (const double noise : {0.0, 0.1, 0.2, 0.3}) {
    const CellKey stairs = stairs_of(results.seed, 8192, noise);
    for (const char* profile : {"paper", "refined"})
      results.cells.push_back(made_up_cell(with_ours(stairs, profile, "gcn"), noise));
    results.cells.push_back(made_up_cell(with_rival(stairs, "oracle"), noise / 2, 100, 99));
  }
  results.real.push_back({"hall", 3, 1, 100000.5, 4321.25, 7});
  return results;
}

inline PaperTimings made_up_timings() {
  PaperTimings timings;
  timings.command = "planescope-lab bench paper --seed 1";
  timings.machine = {"a processor", 2, Simd::avx2};
  timings.threads = 2;
  for (const int points : {2048, 4096, 8192})
    timings.classifiers.push_back({"gcn", points, 1, points / 1000.0});
  timings.real.push_back({"hall", 3, 0.5, 1.5, 0.25, 0.75, 333.3});
  timings.methods.push_back({with_ours(stairs_of(1, 8192, 0.1), "refined", "gcn"), 123.4});
  return timings;
}

}  // namespace planescope::lab
