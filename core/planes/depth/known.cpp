// Creates regions for planes known from other frames, where the depth supports them.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/planes/depth/inverse_depth.hpp"
#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr double kLeastSupport = 100;  // px
// Smallest share of a region's expected pixels that a known plane must explain to claim any.
constexpr double kMostOfPart = 0.7;
constexpr double kVisible = 0.5;  // smallest share of the visible pixels on the plane

/// Pixels that support a known plane in this frame.
struct Support {
  PixelMoments moments;
  std::vector<std::uint32_t> pixels;
};

/// Finds the pixels explained by a known plane. It claims either most or none of the expected
/// pixels of a region, so a plane that merely intersects a surface does not claim a strip of it.
class Supports {
 public:
  explicit Supports(const DepthSegmentation& s) : s_(s), parts_(s.regions.size() + 1) {}

  Support of(const KnownPlane& known) {
    const double reach = s_.options.reach_sigma * std::sqrt(s_.noise.pixel2(known.plane));
    Support support;
    double near = 0, behind = 0;
    std::vector<std::uint32_t> candidates;
    for (const std::uint32_t pixel : known.pixels) {
      const double rho = s_.image.rho[pixel];
      if (rho <= 0) continue;
      const double off = s_.residual(pixel, known.plane);
      const double most = reach + known.slack_m * rho * rho;
      if (off > most) continue;  // hidden
      Part& part = parts_[s_.region_of[pixel] + 1];
      part.expected += 1;
      if (off < -most) {
        behind += 1;
        continue;
      }
      part.near += 1;
      near += 1;
      candidates.push_back(pixel);
    }
    if (near >= kLeastSupport && near >= kVisible * (near + behind))
      for (const std::uint32_t pixel : candidates)
        if (const Part& part = parts_[s_.region_of[pixel] + 1];
            part.near >= kMostOfPart * part.expected) {
          support.pixels.push_back(pixel);
          support.moments.add(s_.u(pixel), s_.v(pixel), s_.image.rho[pixel]);
        }
    for (const std::uint32_t pixel : known.pixels) parts_[s_.region_of[pixel] + 1] = {};
    return support;
  }

 private:
  struct Part {
    double expected = 0, near = 0;
  };
  const DepthSegmentation& s_;
  std::vector<Part> parts_;  // by region + 1; 0: pixels without region
};

/// Whether two known planes are indistinguishable where the first one is expected.
bool are_alike(const DepthSegmentation& s, const KnownPlane& known, const KnownPlane& other) {
  double off2 = 0, rho = 0;
  const auto n = static_cast<double>(known.pixels.size());
  for (const std::uint32_t pixel : known.pixels) {
    const double here = known.plane.at(s.u(pixel), s.v(pixel));
    off2 += std::pow(here - other.plane.at(s.u(pixel), s.v(pixel)), 2) / n;
    rho += here / n;
  }
  return off2 <= std::pow(s.tolerance_of(known, rho), 2);
}

/// The known plane that best explains a pixel.
struct Claim {
  float misfit = std::numeric_limits<float>::infinity();
  std::int32_t known = 0;  // index + 1; 0: none
};

/// One claim per pixel. Known planes explained equally well by a larger one are added to `covered`.
std::vector<Claim> best_known(const DepthSegmentation& s, std::vector<KnownCover>& covered) {
  const std::span<const KnownPlane> known = s.known;
  std::vector<Support> supports;
  std::vector<std::size_t> order;
  Supports found(s);
  for (const KnownPlane& plane : known)
    if (supports.emplace_back(found.of(plane)).moments.n >= kLeastSupport)
      order.push_back(supports.size() - 1);
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t k) { return supports[k].moments.n; });

  std::vector<Claim> best(s.image.pixels());
  std::vector<double> shared(known.size());
  for (const std::size_t k : order) {
    const Support& support = supports[k];
    std::ranges::fill(shared, 0);
    for (const std::uint32_t pixel : support.pixels)
      if (best[pixel].known > 0) shared[best[pixel].known - 1] += 1;
    const auto most = std::ranges::max_element(shared);
    if (*most >= kMostOfPart * support.moments.n) {
      const KnownPlane& by = known[most - shared.begin()];
      if (are_alike(s, known[k], by)) covered.push_back({known[k].id, by.id});
      continue;
    }
    const InversePlane plane = support.moments.fit();
    const double scale = 1 / std::sqrt(s.noise.pixel2(plane));
    for (const std::uint32_t pixel : support.pixels) {
      const auto off = static_cast<float>(scale * std::abs(s.residual(pixel, plane)));
      if (off < best[pixel].misfit) best[pixel] = {off, static_cast<std::int32_t>(k) + 1};
    }
  }
  return best;
}

}  // namespace

std::vector<KnownCover> found_known_regions(DepthSegmentation& s) {
  std::vector<KnownCover> covered;
  if (s.known.empty()) return covered;
  const std::vector<Claim> best = best_known(s, covered);
  struct Founded {
    PixelMoments moments;
    std::int32_t region = kNoRegion;
  };
  std::vector<Founded> founded(s.known.size());
  for (std::uint32_t pixel = 0; pixel < best.size(); ++pixel)
    if (best[pixel].known > 0)
      founded[best[pixel].known - 1].moments.add(s.u(pixel), s.v(pixel), s.image.rho[pixel]);
  for (std::size_t k = 0; k < founded.size(); ++k) {
    const PixelMoments& moments = founded[k].moments;
    if (moments.n < kLeastSupport) continue;
    founded[k].region = static_cast<std::int32_t>(s.regions.size());
    DepthRegion& region = s.regions.emplace_back();
    region.moments = moments;
    region.plane = moments.fit();
    region.known = static_cast<int>(k) + 1;
  }
  for (std::uint32_t pixel = 0; pixel < best.size(); ++pixel) {
    const std::int32_t region =
        best[pixel].known > 0 ? founded[best[pixel].known - 1].region : kNoRegion;
    if (region == kNoRegion) continue;
    std::int32_t& owner = s.region_of[pixel];
    if (owner >= 0) s.regions[owner].moments.remove(s.u(pixel), s.v(pixel), s.image.rho[pixel]);
    owner = region;
  }
  for (DepthRegion& r : s.regions) {
    if (!r.alive || r.known > 0) continue;
    r.alive = r.moments.n >= kLeastSupport;
    if (r.alive) r.plane = r.moments.fit();
  }
  free_pixels_of_ended(s);
  return covered;
}

}  // namespace planescope::planes
