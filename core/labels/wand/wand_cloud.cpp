// The plane wand in a cloud. Like in an image, it fits a plane at the click and grows over
// connected inliers, but over each point's nearest neighbors. Surfaces end only at normals and
// points off the plane, since nothing occludes them.

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand_field.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kLeastPoints = 12;   // of a plane
constexpr std::size_t kPatch = 100;        // points around a click to which its plane is fitted
constexpr double kLeastPatchShare = 0.45;  // of their weights that must be on it
constexpr double kHalf = 3;                // spacings from the click to half weight
constexpr int kFirstSteps = 6;             // of the growth; tripled each time
constexpr int kTurnedSteps = 2;  // from points that face like the plane: normals at edges are mixed
constexpr int kMostRefits = 6;
constexpr double kSettledShare = 0.01;     // of the points
constexpr double kLeastFacingShare = 0.3;  // of points on the plane; below it, normals are useless
constexpr int kSpeckRounds = 3;

/// The points nearest to one, by steps, that are available.
PixelSet patch_around(const LabelGrid& grid, std::uint32_t point) {
  PixelSet patch{point};
  std::vector<std::uint8_t> seen(grid.pixels(), 0);
  seen[point] = 1;
  for (std::size_t k = 0; k < patch.size() && patch.size() < kPatch; ++k)
    for (const std::uint32_t next : grid.graph.around(patch[k]))
      if (!std::exchange(seen[next], std::uint8_t{1})) patch.push_back(next);
  return patch;
}

class CloudGrowth : public Growth {
 public:
  explicit CloudGrowth(const WandField& field) : Growth(field, kLeastPoints) {}

  std::optional<std::uint32_t> free_pixel(std::uint32_t click) const override {
    if (field_.allowed[click]) return click;
    std::optional<std::uint32_t> nearest;
    float least = 0;
    for (const std::uint32_t next : grid_.graph.around(click)) {
      const float apart = (grid_.points[next] - grid_.points[click]).squaredNorm();
      if (!field_.allowed[next] || (nearest && apart >= least)) continue;
      nearest = next;
      least = apart;
    }
    return nearest;
  }

  std::optional<Sheet> plane_at(std::uint32_t click) const override {
    LocalFitOptions options;
    options.half_px = kHalf;
    const auto fit = fit_through(field_, patch_around(grid_, click), options);
    if (!fit || fit->share < kLeastPatchShare) return std::nullopt;
    return fit->sheet;
  }

  bool begin(std::uint32_t click, const Sheet& start) override {
    sheet_ = start;
    return grow({click});
  }

  /// Adds points on the plane that face elsewhere, like those beside an edge, and points that are
  /// off the plane only through noise, surrounded by it.
  bool complete(const std::vector<std::uint32_t>& clicks) override {
    if (clicks.size() > 1 && !grow(clicks)) return false;
    if (facing_) spread(kTurnedSteps);
    for (int round = 0; round < kSpeckRounds; ++round) fill_specks();
    return true;
  }

  PixelSet reach_from(std::uint32_t click, std::vector<std::uint8_t>& reached) const override {
    PixelSet added;
    const auto visit = [&](std::uint32_t i) {
      if (!region_[i] || reached[i]) return;
      reached[i] = 1;
      added.push_back(i);
    };
    visit(click);
    for (const std::uint32_t next : grid_.graph.around(click)) visit(next);
    for (std::size_t k = 0; k < added.size(); ++k)
      for (const std::uint32_t next : grid_.graph.around(added[k])) visit(next);
    return added;
  }

 private:
  /// Grows by increasingly more steps from the clicks and fits the plane again each time, until the
  /// region is complete and settled. Returns false if nothing is left.
  bool grow(const std::vector<std::uint32_t>& clicks) {
    decide_facing(clicks);
    std::size_t before = 0;
    int settled = 0;
    for (int steps = kFirstSteps; settled < kMostRefits; steps = std::min(3 * steps, 1 << 28)) {
      const bool cut_off = regrow(clicks, steps);
      Moments moments;
      for (const std::uint32_t i : taken_) moments.add(grid_.points[i].cast<double>());
      if (!refit(moments)) return false;
      if (cut_off) continue;
      ++settled;
      const auto change =
          std::abs(static_cast<double>(taken_.size()) - static_cast<double>(before));
      if (change <= kSettledShare * static_cast<double>(before)) break;
      before = taken_.size();
    }
    regrow(clicks, 1 << 28);
    return taken_.size() >= kLeastPoints;
  }

  bool takes(std::uint32_t i) const {
    return field_.allowed[i] && field_.lies_on(sheet_, i) && (!facing_ || field_.faces(sheet_, i));
  }

  /// Returns whether the step limit excluded any points.
  bool regrow(const std::vector<std::uint32_t>& clicks, int steps) {
    std::ranges::fill(region_, std::uint8_t{0});
    taken_.clear();
    const auto visit = [&](std::uint32_t i) {
      if (region_[i] || !takes(i)) return;
      region_[i] = 1;
      taken_.push_back(i);
    };
    for (const std::uint32_t click : clicks) {
      visit(click);
      for (const std::uint32_t next : grid_.graph.around(click)) visit(next);
    }
    std::size_t from = 0;
    for (int step = 0; step < steps && from < taken_.size(); ++step)
      for (const std::size_t end = taken_.size(); from < end; ++from)
        for (const std::uint32_t next : grid_.graph.around(taken_[from])) visit(next);
    return from < taken_.size();
  }

  void decide_facing(const std::vector<std::uint32_t>& clicks) {
    regrow(clicks, kFirstSteps);
    const auto facing = static_cast<double>(taken_.size());
    facing_ = false;
    regrow(clicks, kFirstSteps);
    facing_ = facing >= kLeastFacingShare * static_cast<double>(taken_.size());
  }

  void spread(int steps) {
    grow_rings(taken_, steps, [&](std::uint32_t i, auto& next) {
      for (const std::uint32_t j : grid_.graph.around(i)) {
        if (region_[j] || !field_.allowed[j] || !field_.lies_on(sheet_, j)) continue;
        region_[j] = 1;
        next.push_back(j);
        taken_.push_back(j);
      }
    });
  }

  void fill_specks() {
    PixelSet specks;
    for (const std::uint32_t i : taken_)
      for (const std::uint32_t j : grid_.graph.around(i))
        if (!region_[j] && field_.allowed[j] && field_.lies_on(sheet_, j, kLoosely) &&
            is_surrounded(j))
          specks.push_back(j);
    std::ranges::sort(specks);
    specks.erase(std::unique(specks.begin(), specks.end()), specks.end());
    for (const std::uint32_t i : specks) region_[i] = 1;
    taken_.insert(taken_.end(), specks.begin(), specks.end());
  }

  /// By three quarters of its neighbors.
  bool is_surrounded(std::uint32_t point) const {
    const auto around = grid_.graph.around(point);
    const auto in = std::ranges::count_if(around, [&](std::uint32_t j) { return region_[j] != 0; });
    return 4 * static_cast<std::size_t>(in) >= 3 * around.size();
  }

  PixelSet taken_;  // the region, in order of growth
};

}  // namespace

std::unique_ptr<Growth> growth_in_cloud(const WandField& field) {
  return std::make_unique<CloudGrowth>(field);
}

}  // namespace planescope::labels
