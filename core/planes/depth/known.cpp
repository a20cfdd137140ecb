// Founds regions on planes that are known from other frames, where the depth supports them.

#include "core/planes/depth/known.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr double kLeastSupport = 100;  // px
constexpr double kMostOfPart = 0.7;    // a known plane takes a part of a region, or nothing of it
constexpr double kVisible = 0.5;       // least share of what is not hidden, to be there

/// What a frame shows of a known plane.
struct Support {
  PixelMoments moments;
  std::vector<std::uint32_t> pixels;
};

/// Finds the pixels that a known plane explains: of each region, most of the expected pixels or
/// none, so that a plane that merely crosses a surface takes no strip of it.
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
  std::vector<Part> parts_;  // by region + 1; 0: pixels of none
};

}  // namespace

std::vector<KnownCover> found_known_regions(DepthSegmentation& s) {
  std::vector<KnownCover> covered;
  const std::span<const KnownPlane> known = s.known;
  if (known.empty()) return covered;
  std::vector<Support> supports;
  std::vector<std::size_t> order;
  Supports found(s);
  for (const KnownPlane& plane : known)
    if (supports.emplace_back(found.of(plane)).moments.n >= kLeastSupport)
      order.push_back(supports.size() - 1);
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t k) { return supports[k].moments.n; });

  // A pixel goes to the plane that explains it best; what a larger plane explains as well is not
  // apart from it.
  std::vector<float> misfit(s.image.pixels(), std::numeric_limits<float>::infinity());
  std::vector<std::int32_t> best(s.image.pixels(), -1);
  std::vector<double> shared(known.size());
  for (const std::size_t k : order) {
    const Support& support = supports[k];
    std::ranges::fill(shared, 0);
    for (const std::uint32_t pixel : support.pixels)
      if (best[pixel] >= 0) shared[best[pixel]] += 1;
    const auto most = std::ranges::max_element(shared);
    if (*most >= kMostOfPart * support.moments.n) {
      covered.push_back({known[k].id, known[most - shared.begin()].id});
      continue;
    }
    const InversePlane plane = support.moments.fit();
    const double scale = 1 / std::sqrt(s.noise.pixel2(plane));
    for (const std::uint32_t pixel : support.pixels) {
      const auto off = static_cast<float>(scale * std::abs(s.residual(pixel, plane)));
      if (off < misfit[pixel]) misfit[pixel] = off, best[pixel] = static_cast<std::int32_t>(k);
    }
  }

  std::vector<PixelMoments> moments(known.size());
  for (std::uint32_t pixel = 0; pixel < best.size(); ++pixel)
    if (best[pixel] >= 0) moments[best[pixel]].add(s.u(pixel), s.v(pixel), s.image.rho[pixel]);
  std::vector<std::int32_t> region(known.size(), kNoRegion);
  for (std::size_t k = 0; k < known.size(); ++k) {
    if (moments[k].n < kLeastSupport) continue;
    region[k] = static_cast<std::int32_t>(s.regions.size());
    DepthRegion& founded = s.regions.emplace_back();
    founded.moments = moments[k];
    founded.plane = moments[k].fit();
    founded.known = static_cast<int>(k) + 1;
  }
  for (std::uint32_t pixel = 0; pixel < best.size(); ++pixel) {
    if (best[pixel] < 0 || region[best[pixel]] == kNoRegion) continue;
    std::int32_t& owner = s.region_of[pixel];
    if (owner >= 0) s.regions[owner].moments.remove(s.u(pixel), s.v(pixel), s.image.rho[pixel]);
    owner = region[best[pixel]];
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
