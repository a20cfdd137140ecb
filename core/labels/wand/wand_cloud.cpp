// The plane wand in a cloud: as in an image a local fit at the click, then growth over connected
// inliers, but over each point's nearest neighbours. What ends a surface here is its normals and
// what lies off the plane; there is no image in which a surface stands before another.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand_field.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kLeastPoints = 12;   // of a plane
constexpr std::size_t kPatch = 100;        // points around a click that its plane is fitted to
constexpr double kLeastPatchShare = 0.45;  // of their weights must be on it
constexpr double kHalf = 3;                // spacings from the click at which a point counts half
constexpr int kFirstSteps = 6;             // of the growth; then three times as many
constexpr int kTurnedSteps = 2;  // from what faces as the plane: normals at edges are mixed
constexpr int kMostRefits = 6;
constexpr double kSettledShare = 0.01;  // of the points
constexpr double kLeastFacingShare =
    0.3;  // of what lies on the plane; below it normals are useless
constexpr int kSpeckRounds = 3;

/// The points nearest to one, by steps, that are free to take or not.
PixelSet patch_around(const LabelGrid& grid, std::uint32_t point) {
  PixelSet patch{point};
  std::vector<std::uint8_t> seen(grid.pixels(), 0);
  seen[point] = 1;
  for (std::size_t k = 0; k < patch.size() && patch.size() < kPatch; ++k)
    for (const std::uint32_t next : grid.graph.around(patch[k]))
      if (!std::exchange(seen[next], std::uint8_t{1})) patch.push_back(next);
  return patch;
}

std::optional<Sheet> plane_about(const WandField& field, std::uint32_t click) {
  LocalFitOptions options;
  options.half_px = kHalf;
  const auto fit = fit_through(field, patch_around(field.grid, click), options);
  if (!fit || fit->share < kLeastPatchShare) return std::nullopt;
  return fit->sheet;
}

/// The click, or a free point beside it.
std::optional<std::uint32_t> free_point(const WandField& field, std::uint32_t click) {
  if (field.allowed[click]) return click;
  std::optional<std::uint32_t> nearest;
  float least = 0;
  for (const std::uint32_t next : field.grid.graph.around(click)) {
    const float apart = (field.grid.points[next] - field.grid.points[click]).squaredNorm();
    if (!field.allowed[next] || (nearest && apart >= least)) continue;
    nearest = next;
    least = apart;
  }
  return nearest;
}

/// A region and the plane under it, as it grows.
class CloudGrowth {
 public:
  CloudGrowth(const WandField& field, const Sheet& start)
      : field_(field), grid_(field.grid), sheet_(start), region_(grid_.pixels(), 0) {}

  /// In ever longer reaches about the clicks, the plane fitted anew each time, until all is reached
  /// and nothing changes. False where that ends in nothing.
  bool grow(const std::vector<std::uint32_t>& clicks) {
    decide_facing(clicks);
    std::size_t before = 0;
    int settled = 0;
    for (int steps = kFirstSteps; settled < kMostRefits; steps = std::min(3 * steps, 1 << 28)) {
      const bool cut_off = regrow(clicks, steps);
      if (!refit()) return false;
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

  /// What lies on the plane but faces elsewhere, as points beside an edge do; and what is off it by
  /// noise alone, with the plane all around.
  void round_off() {
    if (facing_) spread(kTurnedSteps);
    for (int round = 0; round < kSpeckRounds; ++round) fill_specks();
  }

  const Sheet& sheet() const { return sheet_; }

  /// Adds to `reached` what is connected to a click within the region. Returns the points added.
  PixelSet reach_from(std::uint32_t click, std::vector<std::uint8_t>& reached) const {
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
  bool takes(std::uint32_t i) const {
    return field_.allowed[i] && field_.lies_on(sheet_, i) && (!facing_ || field_.faces(sheet_, i));
  }

  /// Whether points were left for want of steps.
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

  bool refit() {
    Moments moments;
    for (const std::uint32_t i : taken_) moments.add(grid_.points[i].cast<double>());
    const auto refitted = sheet_through(moments);
    if (!refitted || moments.count < kLeastPoints) return false;
    sheet_ = *refitted;
    return true;
  }

  void decide_facing(const std::vector<std::uint32_t>& clicks) {
    regrow(clicks, kFirstSteps);
    const auto facing = static_cast<double>(taken_.size());
    facing_ = false;
    regrow(clicks, kFirstSteps);
    facing_ = facing >= kLeastFacingShare * static_cast<double>(taken_.size());
  }

  void spread(int steps) {
    PixelSet front = taken_, next;
    for (int step = 0; step < steps; ++step) {
      next.clear();
      for (const std::uint32_t i : front)
        for (const std::uint32_t j : grid_.graph.around(i)) {
          if (region_[j] || !field_.allowed[j] || !field_.lies_on(sheet_, j)) continue;
          region_[j] = 1;
          next.push_back(j);
        }
      taken_.insert(taken_.end(), next.begin(), next.end());
      front.swap(next);
    }
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

  /// By three in four of its neighbours.
  bool is_surrounded(std::uint32_t point) const {
    const auto around = grid_.graph.around(point);
    const auto in = std::ranges::count_if(around, [&](std::uint32_t j) { return region_[j] != 0; });
    return 4 * static_cast<std::size_t>(in) >= 3 * around.size();
  }

  const WandField& field_;
  const LabelGrid& grid_;
  Sheet sheet_;
  bool facing_ = true;
  std::vector<std::uint8_t> region_;
  PixelSet taken_;  // the region, as it grew
};

/// Whether a later click means the same plane.
bool is_part(const WandField& field, const Sheet& sheet, std::uint32_t click) {
  const auto there = plane_about(field, click);
  return there && field.lies_on(sheet, click, 2) &&
         std::abs(there->normal.dot(sheet.normal)) >=
             std::cos(field.options.max_angle_deg * std::numbers::pi / 180);
}

}  // namespace

std::optional<WandResult> grow_plane_in_cloud(const WandField& field,
                                              std::span<const std::uint32_t> seeds,
                                              std::string* why_not) {
  const LabelGrid& grid = field.grid;
  const auto refuse = [&](const char* why) {
    if (why_not) *why_not = why;
    return std::nullopt;
  };
  const auto click = free_point(field, seeds[0]);
  if (!click)
    return refuse(!grid.measured[seeds[0]] ? "nothing was measured there"
                  : !field.options.within.empty() && !field.options.within[seeds[0]]
                      ? "it is outside of the lasso"
                      : "it has a label already");
  const auto start = plane_about(field, *click);
  if (!start) return refuse("no plane there");
  std::vector<std::uint32_t> clicks{*click};
  std::vector<std::size_t> seed_of{0};
  CloudGrowth growth(field, *start);
  if (!growth.grow(clicks)) return refuse("no plane there");
  for (std::size_t k = 1; k < seeds.size(); ++k)
    if (const auto other = free_point(field, seeds[k]);
        other && is_part(field, growth.sheet(), *other)) {
      clicks.push_back(*other);
      seed_of.push_back(k);
    }
  if (clicks.size() > 1 && !growth.grow(clicks)) return refuse("no plane there");
  growth.round_off();

  WandResult result;
  result.fragment_pixels.resize(seeds.size(), 0);
  std::vector<std::uint8_t> reached(grid.pixels(), 0);
  for (std::size_t k = 0; k < clicks.size(); ++k) {
    const PixelSet fragment = growth.reach_from(clicks[k], reached);
    result.fragment_pixels[seed_of[k]] = fragment.size();
    result.pixels.insert(result.pixels.end(), fragment.begin(), fragment.end());
  }
  if (result.pixels.size() < kLeastPoints) return refuse("no plane there");
  std::ranges::sort(result.pixels);
  result.plane = fit_plane(grid, result.pixels);
  result.label = class_of_tilt(result.plane.tilt_deg);
  return result;
}

}  // namespace planescope::labels
