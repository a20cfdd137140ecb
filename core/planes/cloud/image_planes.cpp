// Planes of a depth image, fitted in inverse depth.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/model/plane.hpp"
#include "core/planes/cloud/camera.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/simd/pixel_kernels.hpp"

namespace planescope::planes {
namespace {

constexpr int kPatchesAcross = 40;       // patches of 16 pixels in a 640-pixel image
constexpr double kMinFill = 0.6;         // smallest share of measured pixels in a patch
constexpr double kLeastNoise = 0.003;    // of inverse depth [1/m]: 3 mm at 1 m, 27 mm at 3 m
constexpr double kMostNoise = 0.012;     // patches rougher than this are not planar [1/m]
constexpr double kNoiseLength_px = 5;    // correlation length of stereo noise
constexpr double kSystematic_deg = 0.5;  // calibration error left in any normal
constexpr double kMinCosine =
    0.77;  // cosine of the angle (40 deg) between a patch and its plane: bare walls look wavy
constexpr double kBias = 0.003;  // relative range error that averaging does not remove
constexpr int kMinPatches = 6;   // per plane
constexpr int kMaxPlanes = 16;
constexpr double kMaxDepth_m = 10;
constexpr double kFullWeightDepth_m = 2;  // patches farther away gain no more area weight

/// Sums over inverse depth; rays have z = 1.
struct Sums : InverseSums {
  using InverseSums::InverseSums;
  Vec3d mean_ray() const { return rr().col(2) / count; }
  double mean_w() const { return rw()[2] / count; }
};

struct Patch {
  Sums sums;
  InversePlane plane;
  bool planar = false;
  // Planar patches only.
  Vec3d normal = Vec3d::Zero(), mean_ray = Vec3d::Zero();
  double mean_w = 0;
};

struct Patches {
  int across = 0, down = 0;
  std::vector<Patch> all;
  double noise = kLeastNoise;  // typical inverse-depth noise of this image [1/m]
};

/// Interleaves a row of pixels by patch for SIMD: the first pixel of every patch, then the second,
/// and so on.
class PatchRow {
 public:
  PatchRow(std::size_t patches, std::size_t size)
      : size_(size),
        patches_(patches),
        padded_((patches + kPatchLanes - 1) / kPatchLanes * kPatchLanes),
        depth_(size * padded_),
        has_ray_(size * padded_),
        x_(size * padded_),
        y_(size * padded_) {}

  void set_rays(const RayRow& rays) {
    for (std::size_t u = 0; u < size_; ++u)
      for (std::size_t p = 0; p < patches_; ++p) {
        const std::size_t at = u * padded_ + p;
        x_[at] = rays.x[p * size_ + u];
        y_[at] = rays.y[p * size_ + u];
        has_ray_[at] = std::isfinite(x_[at]) && std::isfinite(y_[at]) ? 0xffff : 0;
      }
  }
  /// Call after set_rays() of a row with the same x values.
  void set_y(double y) { std::ranges::fill(y_, y); }
  /// Pixels without a ray get no depth.
  void set_depth(const std::uint16_t* depth) {
    for (std::size_t u = 0; u < size_; ++u)
      for (std::size_t p = 0; p < patches_; ++p) {
        const std::size_t at = u * padded_ + p;
        depth_[at] = depth[p * size_ + u] & has_ray_[at];
      }
  }
  PatchArgs args(double unit_m, double* sums) const {
    return {.patches = padded_,
            .pixels = size_,
            .depth = depth_.data(),
            .ray_x = x_.data(),
            .ray_y = y_.data(),
            .unit_m = unit_m,
            .max_depth_m = kMaxDepth_m,
            .sums = sums};
  }
  std::size_t padded() const { return padded_; }

 private:
  std::size_t size_, patches_, padded_;
  std::vector<std::uint16_t> depth_, has_ray_;  // 0xffff: has a ray
  std::vector<double> x_, y_;
};

/// The sums over each patch of `size` pixels a side, row by row.
std::vector<Sums> sums_of_patches(const Frame& frame, int across, int down, int size) {
  PatchRow row(across, size);
  const std::shared_ptr<const RayTable> table = ray_table(frame.intrinsics);
  const PixelKernels& kernels = pixel_kernels(best_simd());
  std::vector<double> scratch, sums;
  std::vector<Sums> all;
  for (int y = 0; y < down; ++y) {
    sums.assign(kInverseSums * row.padded(), 0);
    for (int v = y * size; v < (y + 1) * size; ++v) {
      const RayRow rays = table->row(v, scratch);
      if (v == 0 || !table->same_x())
        row.set_rays(rays);
      else
        row.set_y(rays.y[0]);
      row.set_depth(&frame.depth.at(0, v));
      kernels.add_to_patches(row.args(frame.depth_unit_m, sums.data()));
    }
    for (int p = 0; p < across; ++p) {
      double of_patch[kInverseSums];
      for (std::size_t s = 0; s < kInverseSums; ++s) of_patch[s] = sums[s * row.padded() + p];
      const int count = static_cast<int>(of_patch[5]);  // sum of z z; z is 1
      all.emplace_back(count, of_patch);
    }
  }
  return all;
}

Patches make_patches(const Frame& frame) {
  const Image16& depth = frame.depth;
  const int size = std::max(4, depth.width / kPatchesAcross);
  Patches patches;
  patches.across = depth.width / size;
  patches.down = depth.height / size;
  for (const Sums& sums : sums_of_patches(frame, patches.across, patches.down, size))
    patches.all.emplace_back().sums = sums;
  std::vector<double> roughness;
  for (Patch& patch : patches.all) {
    if (patch.sums.count < kMinFill * size * size) continue;
    patch.plane = patch.sums.fit();
    patch.planar = patch.plane.rms <= kMostNoise;
    roughness.push_back(patch.plane.rms);
  }
  if (!roughness.empty()) {
    // Edges roughen about half of the patches; the smoothest third reflects the sensor's noise.
    auto third = roughness.begin() + static_cast<std::ptrdiff_t>(roughness.size() / 3);
    std::nth_element(roughness.begin(), third, roughness.end());
    patches.noise = std::clamp(1.5 * *third, kLeastNoise, kMostNoise);
  }
  for (Patch& patch : patches.all) {
    patch.planar = patch.planar && patch.plane.rms <= 2 * patches.noise;
    if (!patch.planar) continue;
    patch.normal = patch.plane.normal();
    patch.mean_ray = patch.sums.mean_ray();
    patch.mean_w = patch.sums.mean_w();
  }
  return patches;
}

/// Area of patches if they were on a plane: rays dx dy cut out z^3 / distance.
class AreaOnPlane {
 public:
  AreaOnPlane(const InversePlane& plane, double pixel_area, double max_depth_m)
      : w_of_ray_(plane.w_of_ray),
        norm_(plane.w_of_ray.norm()),
        pixel_area_(pixel_area),
        max_depth_m_(max_depth_m) {}

  double of_m2(const Patch& patch) const {
    const double z = std::min(max_depth_m_, 1 / w_of_ray_.dot(patch.mean_ray));
    return patch.sums.count * pixel_area_ * z * z * z * norm_;
  }

 private:
  Vec3d w_of_ray_;
  double norm_, pixel_area_, max_depth_m_;
};

class PlaneSearch {
 public:
  PlaneSearch(const Patches& patches, const Intrinsics& k)
      : patches_(patches),
        pixel_area_(std::abs(1 / (k.fx * k.fy))),
        tolerance_(2 * patches.noise),
        free_(patches.all.size()) {
    for (std::size_t i = 0; i < free_.size(); ++i) free_[i] = patches.all[i].planar;
    list_free();
    for (const int reach : {1, 2, 4})
      for (int y = reach % 2; y < patches_.down; y += 2)
        for (int x = reach % 2; x < patches_.across; x += 2)
          guesses_.push_back({.x = x, .y = y, .reach = reach});
  }

  /// Finds the plane with the largest area among the free patches, and claims its patches.
  std::optional<ImagePlane> next() {
    double best_area = 0;
    InversePlane best;
    for (Guess& guess : guesses_) {
      if (guess.changed) {
        guess.plane = fit_block(guess.x, guess.y, guess.reach);
        guess.most_area = guess.plane ? std::numeric_limits<double>::infinity() : 0;
        guess.changed = false;
      }
      if (!(guess.most_area > best_area)) continue;
      guess.most_area = free_area(*guess.plane);
      if (guess.most_area > best_area) {
        best_area = guess.most_area;
        best = *guess.plane;
      }
    }
    if (best_area == 0) return std::nullopt;
    std::vector<int> members;
    for (int round = 0; round < 3; ++round) {
      members = members_of(best);
      if (members.size() < kMinPatches) break;
      best = sum(members).fit();
    }
    if (members.size() < kMinPatches) return std::nullopt;
    take(members);
    return describe(members, best);
  }

 private:
  /// A candidate plane: fitted to the free patches around one patch.
  struct Guess {
    int x = 0, y = 0, reach = 0;
    bool changed = true;  // surrounding patches were claimed since the last fit
    std::optional<InversePlane> plane = {};
    double most_area = 0;  // as last measured: claiming patches only lowers it
  };

  /// The free patches in order, in the kernel's layout, padded with patches that are on no plane.
  struct FreePatches {
    std::vector<int> patch;
    std::vector<double> ray[3], w, most, normal[3];
    std::vector<std::uint8_t> on;
  };

  void list_free() {
    FreePatches& list = list_;
    list = {};
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (free_[i]) list.patch.push_back(static_cast<int>(i));
    const std::size_t padded = (list.patch.size() + kPatchLanes - 1) / kPatchLanes * kPatchLanes;
    for (int axis = 0; axis < 3; ++axis)
      list.ray[axis].resize(padded), list.normal[axis].resize(padded);
    list.w.resize(padded);
    list.most.resize(padded, -1);
    list.on.resize(padded);
    for (std::size_t k = 0; k < list.patch.size(); ++k) {
      const Patch& patch = patches_.all[list.patch[k]];
      for (int axis = 0; axis < 3; ++axis) {
        list.ray[axis][k] = patch.mean_ray[axis];
        list.normal[axis][k] = patch.normal[axis];
      }
      list.w[k] = patch.mean_w;
      list.most[k] = tolerance_ + kBias * patch.mean_w;
    }
  }

  /// Calls visit(i) for the free patches on a plane, in order.
  template <typename Visit>
  void visit_free_on(const InversePlane& plane, const Visit& visit) const {
    const Vec3d normal = plane.normal();
    OnPlaneArgs args{.count = list_.on.size(),
                     .w = list_.w.data(),
                     .most = list_.most.data(),
                     .least_cosine = kMinCosine,
                     .on = list_.on.data()};
    for (int axis = 0; axis < 3; ++axis) {
      args.ray[axis] = list_.ray[axis].data();
      args.normal[axis] = list_.normal[axis].data();
      args.w_of_ray[axis] = plane.w_of_ray[axis];
      args.plane_normal[axis] = normal[axis];
    }
    kernels_.find_on_plane(args);
    for (std::size_t k = 0; k < list_.on.size(); k += kPatchLanes) {
      std::uint64_t any = 0;
      static_assert(kPatchLanes == sizeof(any));
      std::memcpy(&any, &list_.on[k], sizeof(any));
      for (std::size_t lane = 0; any != 0 && lane < kPatchLanes; ++lane)
        if (list_.on[k + lane]) visit(list_.patch[k + lane]);
    }
  }

  double free_area(const InversePlane& plane) const {
    const AreaOnPlane area(plane, pixel_area_, kFullWeightDepth_m);
    double sum_m2 = 0;
    visit_free_on(plane, [&](int i) { sum_m2 += area.of_m2(patches_.all[i]); });
    return sum_m2;
  }

  void take(const std::vector<int>& members) {
    for (const int i : members) free_[i] = 0;
    list_free();
    for (Guess& guess : guesses_)
      guess.changed = guess.changed || std::ranges::any_of(members, [&](int i) {
                        return std::abs(i % patches_.across - guess.x) <= guess.reach &&
                               std::abs(i / patches_.across - guess.y) <= guess.reach;
                      });
  }

  /// Initial plane estimate: the patches around (x, y) that continue the patch at (x, y).
  std::optional<InversePlane> fit_block(int x, int y, int reach) const {
    const int center = y * patches_.across + x;
    if (!free_[center]) return std::nullopt;
    const InversePlane& hint = patches_.all[center].plane;
    const Vec3d normal = hint.normal();
    Sums sums;
    for (int v = std::max(0, y - reach); v <= std::min(patches_.down - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(patches_.across - 1, x + reach); ++u) {
        const int i = v * patches_.across + u;
        if (!free_[i]) continue;
        const Patch& patch = patches_.all[i];
        const double error = hint.w_of_ray.dot(patch.mean_ray) - patch.mean_w;
        // The estimate is rough, increasingly with distance.
        if (patch.normal.dot(normal) >= kMinCosine &&
            std::abs(error) <= 2 * reach * (tolerance_ + kBias * patch.mean_w))
          sums += patch.sums;
      }
    const InversePlane result = sums.fit();
    if (result.rms > 2 * patches_.noise) return std::nullopt;
    return result;
  }

  /// Free patches on the plane that have neighbors on it. Isolated patches are ignored: a plane
  /// through clutter collects them by chance.
  std::vector<int> members_of(const InversePlane& plane) const {
    std::vector<std::uint8_t> on(free_.size(), 0);
    visit_free_on(plane, [&](int i) { on[i] = 1; });
    std::vector<int> members;
    const int across = patches_.across;
    for (int y = 0; y < patches_.down; ++y)
      for (int x = 0; x < across; ++x) {
        const int i = y * across + x;
        if (!on[i]) continue;
        const int company = (x > 0 && on[i - 1]) + (x + 1 < across && on[i + 1]) +
                            (y > 0 && on[i - across]) + (y + 1 < patches_.down && on[i + across]);
        if (company >= 2) members.push_back(i);
      }
    return members;
  }

  Sums sum(const std::vector<int>& members) const {
    Sums sums;
    for (const int i : members) sums += patches_.all[i].sums;
    return sums;
  }

  ImagePlane describe(const std::vector<int>& members, const InversePlane& plane_fit) const {
    const Sums sums = sum(members);
    ImagePlane plane;
    plane.normal = plane_fit.normal();
    plane.pixels = sums.count;
    const Vec3d ray = sums.mean_ray();
    plane.centroid = ray / plane_fit.w_of_ray.dot(ray);
    double nearest_w = 0;
    const AreaOnPlane area(plane_fit, pixel_area_, kFullWeightDepth_m);
    for (const int i : members) {
      plane.area_m2 += area.of_m2(patches_.all[i]);
      nearest_w = std::max(nearest_w, patches_.all[i].mean_w);
    }
    plane.nearest_m = 1 / nearest_w;
    // Covariance of (a, b, c) without the component along itself, which is distance, not direction.
    const double sigma = std::max(patches_.noise, plane_fit.rms) * kNoiseLength_px;
    const Mat3d covariance = sums.rr().ldlt().solve(Mat3d::Identity()) * (sigma * sigma);
    const Mat3d across = Mat3d::Identity() - plane.normal * plane.normal.transpose();
    const double radians =
        std::sqrt((across * covariance * across).trace()) / plane_fit.w_of_ray.norm();
    plane.angle_sigma_deg = std::hypot(radians * 180 / std::numbers::pi, kSystematic_deg);
    return plane;
  }

  const Patches& patches_;
  double pixel_area_;
  double tolerance_;  // of inverse depth [1/m]
  const PixelKernels& kernels_ = pixel_kernels(best_simd());
  std::vector<std::uint8_t> free_;
  mutable FreePatches list_;  // `on` is overwritten on each use
  std::vector<Guess> guesses_;
};

}  // namespace

std::vector<ImagePlane> find_image_planes(const Frame& frame) {
  const Patches patches = make_patches(frame);
  PlaneSearch search(patches, frame.intrinsics);
  std::vector<ImagePlane> planes;
  while (planes.size() < kMaxPlanes) {
    const std::optional<ImagePlane> plane = search.next();
    if (!plane) break;
    planes.push_back(*plane);
  }
  std::stable_sort(planes.begin(), planes.end(),
                   [](const ImagePlane& a, const ImagePlane& b) { return a.area_m2 > b.area_m2; });
  return planes;
}

}  // namespace planescope::planes
