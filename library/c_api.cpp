// C interface on top of the C++ one: no exception crosses it, and results hold everything that
// their accessors return, so that only creating and segmenting can fail.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "library/data.hpp"
#include "planescope/planescope.h"

namespace v0 = planescope::v0;

struct planescope_segmenter {
  v0::Segmenter segmenter;
};

struct planescope_result {
  v0::Result result;
  std::string json;
};

namespace {

// A buffer, because a std::string may fail to hold "out of memory".
thread_local std::array<char, 1024> last_error = {};

template <typename Call>
auto fails_as(decltype(std::declval<Call>()()) failed, const Call& call) noexcept {
  const auto keep = [](const char* text) {
    const std::size_t size = std::min(std::strlen(text), last_error.size() - 1);
    std::copy_n(text, size, last_error.data());
    last_error[size] = '\0';
  };
  try {
    return call();
  } catch (const std::exception& error) {
    keep(error.what());
  } catch (...) {
    keep("unexpected failure");
  }
  return failed;
}

v0::Frame frame_of(const planescope_depth& depth) {
  if ((depth.counts == nullptr) == (depth.meters == nullptr))
    throw v0::Error(fmt::format("depth image: {} meters; expected one or the other",
                                depth.counts ? "both counts and" : "neither counts nor"));
  const planescope_camera& camera = depth.camera;
  v0::DepthImage image;
  image.camera.width = camera.width;
  image.camera.height = camera.height;
  image.camera.fx = camera.fx;
  image.camera.fy = camera.fy;
  image.camera.cx = camera.cx;
  image.camera.cy = camera.cy;
  if (camera.distortion < PLANESCOPE_NO_DISTORTION ||
      camera.distortion > PLANESCOPE_INVERSE_BROWN_CONRADY)
    throw v0::Error(fmt::format(
        "depth image: distortion {}; expected a planescope_distortion, 0 to 2", camera.distortion));
  image.camera.distortion = static_cast<v0::Distortion>(camera.distortion);
  std::copy_n(camera.coefficients, 5, image.camera.coefficients.begin());
  image.unit_m = depth.unit_m == 0 ? 0.001 : depth.unit_m;
  image.row_stride = depth.row_stride;
  image.counts = depth.counts;
  image.meters = depth.meters;
  if (depth.gravity) image.gravity = v0::Vec3{depth.gravity[0], depth.gravity[1], depth.gravity[2]};
  return v0::Frame(image);
}

}  // namespace

const char* planescope_version() { return PLANESCOPE_VERSION; }
const char* planescope_last_error() { return last_error.data(); }

planescope_segmenter* planescope_segmenter_create(const planescope_option* options,
                                                  size_t count,
                                                  int32_t threads) {
  return fails_as(nullptr, [&]() -> planescope_segmenter* {
    v0::Options set;
    for (size_t i = 0; i < count; ++i) {
      if (!options || !options[i].name || !options[i].value)
        throw v0::Error(fmt::format("option {}: NULL; expected a name and a value", i));
      set.set(options[i].name, options[i].value);
    }
    return new planescope_segmenter{v0::Segmenter(set, threads)};
  });
}

void planescope_segmenter_free(planescope_segmenter* segmenter) { delete segmenter; }

planescope_result* planescope_segment(const planescope_segmenter* segmenter,
                                      const planescope_depth* depth) {
  return fails_as(nullptr, [&]() -> planescope_result* {
    if (!segmenter || !depth)
      throw v0::Error("segment: NULL; expected a segmenter and a depth image");
    v0::Result result = segmenter->segmenter.segment(frame_of(*depth));
    std::string json = result.json();  // finds the planes, too
    return new planescope_result{std::move(result), std::move(json)};
  });
}

void planescope_result_free(planescope_result* result) { delete result; }

size_t planescope_result_plane_count(const planescope_result* result) {
  return result->result.planes().size();
}

int32_t planescope_result_plane(const planescope_result* result,
                                size_t index,
                                planescope_plane* plane) {
  return fails_as(-1, [&] {
    const std::vector<v0::Plane>& planes = result->result.planes();
    if (index >= planes.size())
      throw v0::Error(
          fmt::format("plane {} is out of range; the frame has {} planes, numbered from 0", index,
                      planes.size()));
    const v0::Plane& from = planes[index];
    *plane = {from.id,
              static_cast<int32_t>(from.label),
              {from.normal[0], from.normal[1], from.normal[2]},
              {from.centroid[0], from.centroid[1], from.centroid[2]},
              from.offset_m,
              from.tilt_deg,
              from.rms_m,
              from.outline.area_m2,
              from.height_m,
              from.points};
    return 0;
  });
}

const int32_t* planescope_result_labels(const planescope_result* result) {
  return result->result.plane_of().data();
}

void planescope_result_pose(const planescope_result* result, double transform[16]) {
  const v0::Transform pose = result->result.T_world_sensor();
  std::ranges::copy(pose, transform);
}

const char* planescope_result_json(const planescope_result* result) { return result->json.c_str(); }
