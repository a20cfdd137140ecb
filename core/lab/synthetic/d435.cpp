// Depth errors of the RealSense D435: correlated noise, quantization, holes and occlusion.

#include "core/lab/synthetic/d435.hpp"

#include <algorithm>
#include <cmath>

#include "core/lab/synthetic/repeatable.hpp"

namespace planescope::lab {
namespace {

enum Stream : std::uint64_t {
  kMatchingError = 1,
  kDropout = 2,
  kPixelNoise = 3,
  kBow = 4,
  kFlying = 5,
  kBetween = 6,
  kBlind = 7
};

/// One pass of the binomial kernel 1 4 6 4 1 along rows of `stride` 1 or columns. Does not change
/// values within two pixels of the border, which callers crop.
void blur(std::vector<float>& field, int width, int height, bool along_rows) {
  const std::vector<float> in = field;
  const int step = along_rows ? 1 : width;
  const int x_margin = along_rows ? 2 : 0, y_margin = along_rows ? 0 : 2;
  for (int y = y_margin; y < height - y_margin; ++y) {
    for (int x = x_margin; x < width - x_margin; ++x) {
      const float* p = &in[y * width + x];
      field[y * width + x] =
          (p[-2 * step] + p[2 * step] + 4 * (p[-step] + p[step]) + 6 * p[0]) / 16;
    }
  }
}

/// Sum of squares of the kernel after `passes` passes: the factor by which the variance shrinks.
double kernel_energy(int passes) {
  std::vector<double> kernel = {1};
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<double> next(kernel.size() + 4, 0);
    constexpr double kWeights[5] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
    for (std::size_t i = 0; i < kernel.size(); ++i)
      for (int j = 0; j < 5; ++j) next[i + j] += kernel[i] * kWeights[j];
    kernel = next;
  }
  double energy = 0;
  for (const double w : kernel) energy += w * w;
  return energy;
}

/// Gaussian noise of unit variance, correlated over a few pixels: white noise blurred `passes`
/// times.
std::vector<float> correlated_normal(
    int width, int height, int passes, std::uint64_t seed, Stream stream) {
  const int margin = 2 * passes;
  const int w = width + 2 * margin, h = height + 2 * margin;
  std::vector<float> field(static_cast<std::size_t>(w) * h);
  for (std::size_t i = 0; i < field.size(); ++i)
    field[i] = static_cast<float>(random_normal(seed, stream, i));
  for (int pass = 0; pass < passes; ++pass) {
    blur(field, w, h, true);
    blur(field, w, h, false);
  }
  const auto scale =
      static_cast<float>(1 / kernel_energy(passes));  // rows and columns: the root of its square
  std::vector<float> out(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out[y * width + x] = field[(y + margin) * w + x + margin] * scale;
  return out;
}

/// Value noise of unit variance: Gaussian at the corners of a grid of cells `cell_px` wide,
/// smoothly interpolated between them.
class SmoothNormal {
 public:
  SmoothNormal(int width, int cell_px, std::uint64_t seed, Stream stream)
      : corners_(width / cell_px + 2), cell_px_(cell_px), seed_(seed), stream_(stream) {}

  double at(int x, int y) const {
    const int i = x / cell_px_, j = y / cell_px_;
    const double s = smooth(x), t = smooth(y);
    const double u = 1 - s, v = 1 - t;
    const double sum = v * (u * corner(i, j) + s * corner(i + 1, j)) +
                       t * (u * corner(i, j + 1) + s * corner(i + 1, j + 1));
    return sum / std::sqrt((u * u + s * s) * (v * v + t * t));
  }

 private:
  double smooth(int x) const {
    const double f = static_cast<double>(x % cell_px_) / cell_px_;
    return f * f * (3 - 2 * f);
  }
  double corner(int i, int j) const {
    return random_normal(seed_, stream_, static_cast<std::uint64_t>(j) * corners_ + i);
  }
  std::uint64_t corners_;
  int cell_px_;
  std::uint64_t seed_;
  Stream stream_;
};

bool is_over(const SmoothNormal& noise, double limit, int x, int y) {
  return limit < D435Model::kNever && noise.at(x, y) > limit;
}

/// 0 below the start of the grazing angles, 1 above their end, smooth in between.
double grazing(double cos_incidence, const D435Model& model) {
  const double start = cos_deg(model.grazing_start_deg), end = cos_deg(model.grazing_end_deg);
  const double t = std::clamp((start - cos_incidence) / (start - end), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// The disparity of another surface, at least 1.5 px different, within the matching window around a
/// pixel; the pixel's own if there is none.
double beyond_jump(const std::vector<double>& disparity, const Intrinsics& k, int x, int y) {
  constexpr int kReach = 2;
  const double here = disparity[y * k.width + x];
  for (const int offset : {-kReach, kReach}) {
    const int nx = std::clamp(x + offset, 0, k.width - 1);
    const int ny = std::clamp(y + offset, 0, k.height - 1);
    for (const double there : {disparity[y * k.width + nx], disparity[ny * k.width + x]})
      if (std::abs(there - here) > 1.5) return there;
  }
  return here;
}

std::uint16_t to_counts(double depth_m, const D435Model& model) {
  const double counts = std::round(depth_m / model.depth_unit_m);
  return counts >= 1 && counts <= 65535 ? static_cast<std::uint16_t>(counts) : std::uint16_t{0};
}

}  // namespace

Intrinsics d435_intrinsics(int width, int height) {
  Intrinsics k;
  k.width = width;
  k.height = height;
  k.fx = k.fy = 385.0 * width / 640;
  k.cx = (width - 1) / 2.0;
  k.cy = (height - 1) / 2.0;
  return k;
}

double depth_sigma_m(const D435Model& model, double z_m) {
  const double per_pixel = z_m * z_m / (model.intrinsics.fx * model.baseline_m);
  const double step_variance = model.disparity_step_px * model.disparity_step_px / 12;
  const double sigma = model.disparity_sigma_px;
  return per_pixel * std::sqrt(sigma * sigma + step_variance);
}

Image16 measure_depth(const TrueView& view, const D435Model& model, std::uint64_t seed) {
  const Intrinsics& k = model.intrinsics;
  Image16 depth(k.width, k.height);
  if (!model.noise) {
    for (std::size_t i = 0; i < depth.data.size(); ++i)
      depth.data[i] = to_counts(view.depth_m[i], model);
    return depth;
  }
  const double fb = k.fx * model.baseline_m;
  std::vector<double> disparity(view.depth_m.size(), 0);
  for (std::size_t i = 0; i < disparity.size(); ++i)
    if (view.depth_m[i] > 0) disparity[i] = fb / view.depth_m[i];
  const auto error =
      correlated_normal(k.width, k.height, model.correlation_px, seed, kMatchingError);
  const auto dropout = correlated_normal(k.width, k.height, 4, seed, kDropout);
  const SmoothNormal bow(k.width, model.bow_px, seed, kBow);
  constexpr int kFlyingCell_px = 6, kBlindCell_px = 48;
  const SmoothNormal flying(k.width, kFlyingCell_px, seed, kFlying);
  const SmoothNormal blind(k.width, kBlindCell_px, seed, kBlind);

  for (int y = 0; y < k.height; ++y) {
    for (int x = 0; x < k.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * k.width + x;
      const double true_disparity = disparity[i];
      if (true_disparity <= 0 || !view.in_both_eyes[i]) continue;
      // The band at the left edge is outside the right image.
      if (x - true_disparity < 0 || true_disparity > model.max_disparity_px) continue;
      // Matching fails in patches: rarely elsewhere, often at jumps and at grazing angles.
      double threshold = 3.3 - 5.5 * grazing(view.cos_incidence[i], model);
      const double beyond = beyond_jump(disparity, k, x, y);
      if (beyond != true_disparity) threshold -= 2.6;
      if (dropout[i] > threshold) continue;
      if (is_over(blind, model.blind_from, x, y)) continue;

      double noisy = true_disparity + model.disparity_sigma_px * error[i];
      if (model.bow_sigma_px > 0) noisy += model.bow_sigma_px * bow.at(x, y);
      if (beyond != true_disparity && beyond > 0 && is_over(flying, model.flying_from, x, y))
        noisy += random_uniform(seed, kBetween, i) * (beyond - true_disparity);
      const double step = model.disparity_step_px;
      const double matched = step > 0 ? step * std::round(noisy / step) : noisy;
      if (matched <= 0 || fb / matched > model.max_range_m) continue;
      depth.data[i] = to_counts(fb / matched, model);
    }
  }
  return depth;
}

Image16 measure_with_pixel_noise(const TrueView& view, const D435Model& model, std::uint64_t seed) {
  Image16 depth(model.intrinsics.width, model.intrinsics.height);
  for (std::size_t i = 0; i < depth.data.size(); ++i) {
    const double z = view.depth_m[i];
    if (z <= 0) continue;
    depth.data[i] =
        to_counts(z + depth_sigma_m(model, z) * random_normal(seed, kPixelNoise, i), model);
  }
  return depth;
}

}  // namespace planescope::lab
