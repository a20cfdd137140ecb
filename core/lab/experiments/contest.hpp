#pragma once

// Runs competing methods on one frame.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/lab/experiments/cells.hpp"
#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {

/// The classifiers that label points for our method.
struct Labellers {
  std::shared_ptr<const planes::Classifier> gcn, pca;
};

/// Ground truth of a frame, from its labels or from the fields of its cloud.
planes::SourceTruth truth_of(const EvaluationFrame& frame);

/// One frame and all methods that find planes in it. Labels points once for all profiles.
class Contest {
 public:
  /// `truth`: of the frame, for keys with true labels; may be null. `max_range_m`: overrides
  /// cell_options(). All of them must outlive the contest.
  Contest(const Frame& frame,
          const Labellers& labellers,
          const planes::SourceTruth* truth,
          std::optional<double> max_range_m = {});

  /// Runs with cell_options(key); supports all methods except the oracle.
  planes::FrameResult run(const CellKey& key);
  /// The frame with labels from "gcn", "pca", "truth" or "none", prepared for the key's profile.
  const planes::PreparedFrame& prepared(const std::string& labels, const CellKey& key);

 private:
  planes::PipelineOptions options(const CellKey& key) const;

  const Frame& frame_;
  const Labellers& labellers_;
  planes::FrameTruth on_points_;
  std::optional<double> max_range_m_;
  // By the source of labels, and whether planes are found on pixels.
  std::map<std::pair<std::string, bool>, planes::PreparedFrame> prepared_;
};

/// Calls measure(frame), which returns a value for each method, for all frames. Results by method,
/// then by frame. Independent of the number of threads. `progress(done, all)` may be empty and may
/// throw to stop.
template <typename Value>
std::vector<std::vector<Value>> of_methods(std::size_t methods,
                                           int frames,
                                           int threads,
                                           const std::function<std::vector<Value>(int)>& measure,
                                           const std::function<void(int, int)>& progress) {
  std::vector<std::vector<Value>> by_frame(static_cast<std::size_t>(frames));
  work_through(
      frames, threads, [&](int i) { by_frame[static_cast<std::size_t>(i)] = measure(i); },
      progress);
  std::vector<std::vector<Value>> by_method(methods);
  for (std::vector<Value>& values : by_frame)
    for (std::size_t m = 0; m < methods; ++m) by_method[m].push_back(std::move(values[m]));
  return by_method;
}

// The oracle is the upper bound for geometry alone: it assigns each point to the nearest true
// plane, within the plane's true boundary from the generator.

/// Distance from a point to the nearest point of the polygon [m].
double distance_m(const TruePolygon& polygon, const Vec3d& point);

/// The plane of the polygon nearest to each point (the first of equally near ones), 0 if that
/// polygon is part of a curved surface.
std::vector<std::int32_t> oracle_planes(std::span<const Vec3f> points,
                                        std::span<const TruePolygon> polygons);

/// The oracle as a method, to be scored like the others: assigns every voxel to the nearest polygon
/// (in the frame's own coordinates) and fits planes to their voxels by least squares.
planes::FrameResult oracle_result(const planes::PreparedFrame& prepared,
                                  std::span<const TruePolygon> polygons);

}  // namespace planescope::lab
