#pragma once

// Methods against each other on one frame.

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

/// One frame and all methods that find planes in it. Points are labelled once for all profiles.
class Contest {
 public:
  /// `truth`: of the frame, for keys with true labels; may be null. `max_range_m`: another one than
  /// cell_options() has. All of them outlive the contest.
  Contest(const Frame& frame,
          const Labellers& labellers,
          const planes::SourceTruth* truth,
          std::optional<double> max_range_m = {});

  /// With cell_options(key); all methods but the oracle.
  planes::FrameResult run(const CellKey& key);
  /// The frame with labels of "gcn", "pca", "truth" or "none", as the key's profile takes it.
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

/// measure(frame), a value for each method, of all frames; by method, then by frame. The same for
/// any number of threads. `progress(done, all)` may be empty and may throw to stop.
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

// The oracle is the best that geometry alone can do: each point to its nearest true plane, where
// that plane ends as the generator made it.

/// Distance from a point to the nearest point of the polygon [m].
double distance_m(const TruePolygon& polygon, const Vec3d& point);

/// Per point the plane of the polygon that is nearest to it (of equally near ones the first), 0
/// where that is something curved.
std::vector<std::int32_t> oracle_planes(std::span<const Vec3f> points,
                                        std::span<const TruePolygon> polygons);

/// The oracle as a method, to be scored like all others: every voxel to the nearest of the polygons
/// (in the frame's own coordinates), planes fitted to their voxels by least squares.
planes::FrameResult oracle_result(const planes::PreparedFrame& prepared,
                                  std::span<const TruePolygon> polygons);

}  // namespace planescope::lab
