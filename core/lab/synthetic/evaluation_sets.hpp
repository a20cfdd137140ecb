#pragma once

// The sets on which methods are measured: the paper's stairs, harder whole objects that are not in
// the paper, and depth frames through the camera model. All come from seeds, with the same bytes
// everywhere.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/frame.hpp"

namespace planescope::lab {

enum class DepthErrors : std::uint8_t {
  clean,  // exact depth, rounded to counts, wherever a ray hits
  noise,  // independent Gaussian noise on every pixel, as strong as the D435's at its depth
  d435,   // the whole camera model
};
const char* to_string(DepthErrors errors);                // "clean", "noise", "d435"
DepthErrors parse_depth_errors(const std::string& text);  // throws Error

struct EvaluationSet {
  std::string name;     // "stairs", "open_risers", "depth_boxes"
  std::string meaning;  // one phrase
  bool depth = false;  // depth images with truth by pixel; otherwise clouds with label and instance
  int frames = 0;      // by default
};
/// stairs; side_walls, open_risers, equal_boxes, ramps, kerbs, spiral; depth_stairs, depth_boxes,
/// depth_slopes, depth_descent.
const std::vector<EvaluationSet>& evaluation_sets();
/// Throws Error that lists the sets.
const EvaluationSet& find_evaluation_set(const std::string& name);

struct EvaluationOptions {
  std::uint64_t seed = 1;
  int points = 8192;                        // clouds: farthest point sampling; 0 = dense
  double noise_m = 0;                       // clouds: Gaussian, added after sampling
  DepthErrors errors = DepthErrors::clean;  // depth images
};

/// A frame and its exact ground truth, in its own coordinates (sensor axes for depth images).
struct EvaluationFrame {
  std::string name;                   // "open_risers_003"
  Frame frame;                        // with known gravity; clouds have label and instance
  std::optional<FrameLabels> labels;  // depth images: by pixel
  std::vector<Vec3d> normals;         // exact, by plane id - 1
  std::vector<TruePolygon> polygons;
  std::optional<TrueStairs> stairs;  // depth_stairs, depth_descent
};

/// Frame `index` of a set, independent of previous calls. The geometry of depth sets does not
/// depend on `errors`.
EvaluationFrame make_evaluation_frame(const EvaluationSet& set,
                                      int index,
                                      const EvaluationOptions& options);

}  // namespace planescope::lab
