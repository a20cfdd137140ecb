#pragma once

// Tracks and maps against a synthetic walk whose planes and poses are known exactly.

#include <functional>
#include <string>
#include <utility>
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
  int true_planes = 0;
  std::vector<std::pair<int, double>> missing;  // ids, and how much was in sight [m2]
  int twice = 0;   // map planes that cover again what a larger one covers
  int ghosts = 0;  // map planes over 100 cm2 that are on no true plane
  struct Plane {
    int track = 0, truth = 0;                         // ids; truth 0: a ghost
    double area_m2 = 0, offset_m = 0, angle_deg = 0;  // from the true one, at its centroid
  };
  std::vector<Plane> planes;  // of the map, those that are there at the end
  struct Change {
    int truth = 0, frame = 0, before = 0, now = 0;
    bool in_a_row = false;
  };
  std::vector<Change> changes;    // of tracks, what `switches` and `not_known_again` count
  int within = 0;                 // 5 mm and 0.5 degrees
  double way_m = 0, drift_m = 0;  // of the camera; where it was thought to be at the end
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
/// One walk's: planes of the map beside the true ones; where a true plane changed its track.
Table map_planes_table(const MapScore& score);
Table track_changes_table(const MapScore& score);

}  // namespace planescope::lab
