// Finds planes in a depth image: segment_depth
// The image is synthetic: a camera 30 cm above a floor, and 1 m ahead a step of 15 cm.

#include <cmath>
#include <cstdio>
#include <planescope/core.hpp>
#include <vector>

int main() try {
  planescope::DepthImage image;
  image.camera = {424, 240, 300, 300, 211.5, 119.5};
  image.unit_m = 0.001;
  image.gravity = {0, 1, 0};  // the camera is level, so gravity is its y axis

  std::vector<std::uint16_t> counts;
  for (int v = 0; v < image.camera.height; ++v)
    for (int u = 0; u < image.camera.width; ++u) {
      // drop of the ray per meter ahead
      const double down = (v - image.camera.cy) / image.camera.fy;
      double z = down > 0.3 ? 0.30 / down : down > 0.15 ? 1.0 : down > 0.05 ? 0.15 / down : 0;
      counts.push_back(static_cast<std::uint16_t>(std::lround(z / image.unit_m)));
    }
  image.counts = counts.data();

  const planescope::Result result = planescope::segment(image);
  for (const planescope::Plane& plane : result.planes())
    std::printf("plane %d: %s, %.0f deg, %.2f m2, %.1f mm rough, %.0f mm above the floor\n",
                plane.id, plane.label == planescope::Label::h ? "h" : "v", plane.tilt_deg,
                plane.outline.area_m2, plane.rms_m * 1e3, plane.height_m * 1e3);
  return result.planes().empty();
} catch (const planescope::Error& error) {
  std::fprintf(stderr, "segment_depth: %s\n", error.what());
  return 2;
}
