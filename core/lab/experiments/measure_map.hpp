#pragma once

// Tracks and maps against a synthetic walk whose planes and poses are known exactly.

#include <functional>
#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/lab/synthetic/sequence.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::lab {

struct MapScore {
  int frames = 0, plane_frames = 0;  // found planes that stand for a true one, over all frames
  // A true plane, found in two frames in a row, has changed its track; or, found again after frames
  // without it, has not kept it.
  int switches = 0, not_known_again = 0;
  int true_tracks = 0;  // true planes in sight, one time each
  int breaks = 0;  // frames in a row in which one is in sight and not found, found on both sides
  // The map. A true plane counts where more than kLeastSeen of it was in sight.
  static constexpr double kLeastSeen_m2 = 0.04;
  int true_planes = 0, missing = 0;
  int twice = 0;                            // map planes that cover again what a larger one covers
  int ghosts = 0;                           // map planes over 100 cm2 that are on no true plane
  std::vector<double> offset_m, angle_deg;  // of map planes from the true ones, at their centroids
  int within = 0;                           // 5 mm and 0.5 degrees
  double way_m = 0, drift_m = 0;            // of the camera; where it was thought to be at the end
  world::Stability stability;
};

struct MapBenchOptions {
  SequenceOptions sequence;
  planes::PipelineOptions pipeline;
  world::TrackOptions tracks;
  bool odometry = false;  // else the true poses
};

/// Throws Cancelled when stopped.
MapScore measure_map(const MapBenchOptions& options,
                     const planes::Classifier& classifier,
                     const std::function<void(int done, int all)>& progress = {});

/// `names`: of the scores, a column each.
Table map_table(const std::vector<MapScore>& scores, const std::vector<std::string>& names);

}  // namespace planescope::lab
