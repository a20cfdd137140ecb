#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/label.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

/// One value per point. The margin says how sure: 0 on the boundary, 1 certain.
struct Classification {
  std::vector<Label> labels;
  std::vector<float> margins;
};

/// Labels a batch of points. Re-entrant, the same answer for any thread count and, up to the order
/// of the output, for any order of the points.
class Classifier {
 public:
  virtual ~Classifier() = default;
  virtual std::string name() const = 0;  // as --classifier calls it
  /// `points`: one cloud, world frame (z up), metres, about a local origin.
  virtual Classification classify(std::span<const Vec3f> points, int threads) const = 0;
};

/// The same for a cloud wherever it stands: its coordinates are taken from its lower corner on.
Classification classify_about_origin(const Classifier& classifier,
                                     std::span<const Vec3d> points,
                                     int threads);

struct PcaClassifierOptions {
  int neighbours = 16;        // points in each local fit, itself included
  double max_angle_deg = 45;  // Eq. (1): h up to pi/4 from gravity
};
std::unique_ptr<Classifier> make_pca_classifier(const PcaClassifierOptions& options = {});

}  // namespace planescope::planes
