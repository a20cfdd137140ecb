// Fits planes to a few pixels, and finds the borders of the wand's regions.

#include "core/labels/wand/wand_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/labels/model/pixel_sets.hpp"
#include "core/model/plane.hpp"
#include "core/model/random.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kLeastFitPixels = 6;
constexpr int kRefits = 3;
constexpr double kHintShare = 0.7;

struct Weighted {
  std::uint32_t pixel = 0;
  float weight = 0;
};

std::optional<Sheet> sheet_through(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f normal = (b - a).cross(c - a);
  const float length = normal.norm();
  if (!(length > 0.05f * (b - a).norm() * (c - a).norm())) return std::nullopt;
  return Sheet{normal / length, normal.dot(a) / length};
}

/// Sum of weights of pixels on the sheet, decreasing with the distance from it.
float score(const WandField& field, const std::vector<Weighted>& all, const Sheet& sheet) {
  float sum = 0;
  for (const auto& [pixel, weight] : all) {
    const float d = sheet.distance_m(field.grid.points[pixel]) / field.tolerance_m(sheet, pixel);
    sum += weight * std::max(0.0f, 1 - d * d);
  }
  return sum;
}

std::optional<Sheet> best_of_samples(const WandField& field,
                                     const std::vector<Weighted>& all,
                                     int samples) {
  Random random(1);
  const int last = static_cast<int>(all.size()) - 1;
  std::optional<Sheet> best;
  float best_score = 0;
  for (int k = 0; k < samples; ++k) {
    std::array<Vec3f, 3> points;
    for (Vec3f& point : points) point = field.grid.points[all[random.integer(0, last)].pixel];
    const auto sheet = sheet_through(points[0], points[1], points[2]);
    if (!sheet) continue;
    if (const float s = score(field, all, *sheet); s > best_score) {
      best_score = s;
      best = sheet;
    }
  }
  return best;
}

std::optional<LocalFit> fit_weighted(const WandField& field,
                                     const std::vector<Weighted>& all,
                                     double weights,
                                     const LocalFitOptions& options) {
  const LabelGrid& grid = field.grid;
  if (all.size() < kLeastFitPixels) return std::nullopt;

  const auto share_of = [&](const Sheet& sheet) {
    double share = 0;
    for (const auto& [pixel, weight] : all)
      if (field.lies_on(sheet, pixel)) share += weight;
    return share / weights;
  };
  for (const Sheet& hint : options.hints)
    if (const double share = share_of(hint); share >= kHintShare) return LocalFit{hint, share};

  std::optional<Sheet> best = best_of_samples(field, all, options.samples);
  for (int k = 0; k < kRefits && best; ++k) {
    Moments moments;
    for (const auto& [pixel, weight] : all)
      if (field.lies_on(*best, pixel)) moments.add(grid.points[pixel].cast<double>());
    const auto refitted = labels::sheet_through(moments);
    if (!refitted) break;
    best = refitted;
  }
  if (!best) return std::nullopt;
  return LocalFit{*best, share_of(*best)};
}

}  // namespace

std::optional<Sheet> sheet_through(const Moments& moments) {
  const auto fit = facing_sensor(fit_plane(moments));
  if (!fit) return std::nullopt;
  return Sheet{fit->normal.cast<float>(), static_cast<float>(fit->offset_m())};
}

WandField make_wand_field(const LabelGrid& grid,
                          const FrameLabels* labels,
                          const WandOptions& options) {
  const double max_angle = options.max_angle_deg * std::numbers::pi / 180;
  WandField field{grid, options, {}, grid.measured, static_cast<float>(std::cos(max_angle))};
  field.noise.resize(grid.pixels(), 0);
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    field.noise[i] = grid.is_cloud()
                         ? grid.sigma_m[i]
                         : grid.sigma_m[i] / grid.points[i].norm();  // NaN if not measured
  for (std::size_t i = 0; i < options.within.size(); ++i)
    if (!options.within[i]) field.allowed[i] = 0;
  if (!labels) return field;
  std::vector<std::uint8_t> keeps(kPlaneIgnore + 1, options.take_labeled ? 0 : 1);
  keeps[0] = 0;
  for (const LabelPlane& plane : labels->planes)
    if (plane.locked || plane.hidden) keeps[plane.id] = 1;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (keeps[labels->plane.data[i]]) field.allowed[i] = 0;
  return field;
}

std::optional<LocalFit> fit_around(const WandField& field,
                                   const std::vector<std::uint8_t>& usable,
                                   const PixelBox& box,
                                   std::uint32_t middle,
                                   const LocalFitOptions& options) {
  const LabelGrid& grid = field.grid;
  const double area = static_cast<double>(box.u1 - box.u0) * (box.v1 - box.v0);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(area / options.most_pixels))));
  const int middle_u = static_cast<int>(middle) % grid.width;
  const int middle_v = static_cast<int>(middle) / grid.width;
  std::vector<Weighted> all;
  double weights = 0;
  for (int v = box.v0 + (middle_v - box.v0) % step; v < box.v1; v += step)
    for (int u = box.u0 + (middle_u - box.u0) % step; u < box.u1; u += step) {
      const auto pixel = static_cast<std::uint32_t>(v * grid.width + u);
      if (!usable[pixel]) continue;
      const double du = (u - middle_u) / options.half_px, dv = (v - middle_v) / options.half_px;
      all.push_back({pixel, static_cast<float>(1 / (1 + du * du + dv * dv))});
      weights += all.back().weight;
    }
  return fit_weighted(field, all, weights, options);
}

std::optional<LocalFit> fit_through(const WandField& field,
                                    std::span<const std::uint32_t> pixels,
                                    const LocalFitOptions& options) {
  if (pixels.empty()) return std::nullopt;
  const Vec3f middle = field.grid.points[pixels[0]];
  const double half_m = options.half_px * std::max(field.grid.spacing_m, 1e-6);
  const auto most = static_cast<std::size_t>(options.most_pixels);
  const std::size_t step = (pixels.size() + most - 1) / most;
  std::vector<Weighted> all;
  double weights = 0;
  for (std::size_t k = 0; k < pixels.size(); k += step) {
    const double away =
        static_cast<double>((field.grid.points[pixels[k]] - middle).norm()) / half_m;
    all.push_back({pixels[k], static_cast<float>(1 / (1 + away * away))});
    weights += static_cast<double>(all.back().weight);
  }
  return fit_weighted(field, all, weights, options);
}

// Borders of the wand's regions.

// Creases. Where two surfaces meet at an angle, points near the edge are within tolerance of both
// planes. The other surface continues outside the region: its plane is fitted there, tile by tile
// along the border, and each pixel near the border is assigned to the nearer plane.

namespace {

constexpr int kTile_px = 16;
constexpr int kLeastCrease_px = 12;  // beyond the tile, to each side
constexpr int kMostCrease_px = 80;
constexpr std::size_t kLeastContact_px = 3;  // of a tile's pixels
constexpr double kLeastCreaseShare = 0.3;    // of pixels beyond, that must be on the other surface
constexpr double kLeastSine = 0.12;          // of the angle: flatter creases are ignored
constexpr double kFlatSine = 0.35;           // below it, average over more pixels against noise
constexpr float kLeaves = 1.8f;              // tolerances from the sheet: a surface, not a bump
constexpr double kLeastLeaving = 0.2;        // of the other surface's pixels that must be that far
constexpr int kLong_px = 60;                 // in a window this large, ...
constexpr double kLeastLong = 0.3;           // ... minimum share of the other surface
constexpr int kMostSurfaces = 2;             // that meet the region in one tile
constexpr std::size_t kRemembered = 6;       // surfaces, for the following tiles

using Tile = std::vector<std::uint32_t>;

/// Pixels just outside the region that continue it without a step in depth, by tile.
std::vector<Tile> contacts_by_tile(const WandField& field,
                                   const Sheet& sheet,
                                   const PixelBox& box,
                                   const std::vector<std::uint8_t>& region) {
  const LabelGrid& grid = field.grid;
  const int width = grid.width, height = grid.height;
  const int across = (width + kTile_px - 1) / kTile_px, down = (height + kTile_px - 1) / kTile_px;
  std::vector<Tile> tiles(static_cast<std::size_t>(across) * down);
  for (int v = std::max(box.v0, 1); v < std::min(box.v1, height - 1); ++v)
    for (int u = std::max(box.u0, 1); u < std::min(box.u1, width - 1); ++u) {
      const auto i = static_cast<std::uint32_t>(v * width + u);
      if (region[i] || !grid.measured[i]) continue;
      if (!region[i - 1] && !region[i + 1] && !region[i - width] && !region[i + width]) continue;
      if (field.lies_on(sheet, i, 3)) tiles[v / kTile_px * across + u / kTile_px].push_back(i);
    }
  return tiles;
}

class CreaseCut {
 public:
  CreaseCut(const WandField& field, const Sheet& sheet, std::vector<std::uint8_t>& region)
      : field_(field),
        grid_(field.grid),
        sheet_(sheet),
        region_(region),
        outside_(grid_.pixels(), 0),
        goes_(grid_.pixels(), 0) {
    for (std::size_t i = 0; i < outside_.size(); ++i) outside_[i] = grid_.measured[i] && !region[i];
  }

  void cut_at(const Tile& contacts) {
    Tile open = contacts;
    for (int k = 0; k < kMostSurfaces && open.size() >= kLeastContact_px; ++k) {
      const std::uint32_t middle = open[open.size() / 2];
      const double tolerance_px = field_.tolerance_m(sheet_, middle) *
                                  std::abs(grid_.intrinsics.fx) / grid_.points[middle].z();
      const auto other = surface_beyond(middle, tolerance_px);
      if (!other) return;
      Tile front;
      std::erase_if(open, [&](std::uint32_t i) {
        const bool on = field_.lies_on(*other, i);
        if (on) front.push_back(i);
        return on;
      });
      if (front.empty()) return;
      const double sine = sine_to(*other);
      const int deep = static_cast<int>(std::min(1.3 * tolerance_px / sine, 60.0)) + 2;
      take(*other, std::move(front), deep, sine < kFlatSine ? 3 : 1);
    }
  }

  void finish() {
    for (std::size_t i = 0; i < region_.size(); ++i)
      if (goes_[i]) region_[i] = 0;
  }

 private:
  double sine_to(const Sheet& other) const { return other.normal.cross(sheet_.normal).norm(); }

  /// The surface that continues outside the region at `middle`. Flatter creases need a larger
  /// window to separate the two.
  std::optional<Sheet> surface_beyond(std::uint32_t middle, double tolerance_px) {
    for (const double tolerances : {2.0, 5.0}) {
      const int beyond =
          std::clamp(static_cast<int>(tolerances * tolerance_px), kLeastCrease_px, kMostCrease_px);
      const PixelBox box = box_around(grid_, middle, kTile_px / 2 + beyond);
      LocalFitOptions options;
      options.half_px = beyond;
      options.samples = 32;
      options.most_pixels = 144;
      options.hints = known_;
      const auto fit = fit_around(field_, outside_, box, middle, options);
      if (!fit || fit->share < kLeastCreaseShare) return std::nullopt;
      if (sine_to(fit->sheet) < kLeastSine || !is_surface(fit->sheet, box)) continue;
      remember(fit->sheet);
      return fit->sheet;
    }
    return std::nullopt;
  }

  void remember(const Sheet& other) {
    if (std::ranges::any_of(known_, [&](const Sheet& s) {
          return s.normal == other.normal && s.offset_m == other.offset_m;
        }))
      return;
    if (known_.size() == kRemembered) known_.erase(known_.begin());
    known_.push_back(other);
  }

  /// Not a bump in the region's own surface: it exceeds the noise, or is large.
  bool is_surface(const Sheet& other, const PixelBox& box) const {
    int all = 0, on = 0, far = 0;
    for (int v = box.v0; v < box.v1; v += 2)
      for (int u = box.u0; u < box.u1; u += 2) {
        const auto i = static_cast<std::uint32_t>(v * grid_.width + u);
        ++all;
        if (!outside_[i] || !field_.lies_on(other, i)) continue;
        ++on;
        far += !field_.lies_on(sheet_, i, kLeaves);
      }
    return far > kLeastLeaving * on || (box.u1 - box.u0 > kLong_px && on > kLeastLong * all);
  }

  /// Grows into the region from where the other surface touches it, by at most `deep` pixels.
  void take(const Sheet& other, Tile front, int deep, int blur) {
    grow_rings(std::move(front), deep, [&](std::uint32_t i, auto& next) {
      for_sides(i, grid_.width, grid_.height, [&](std::uint32_t j) {
        if (!region_[j] || goes_[j] || !is_nearer(other, j, blur)) return;
        goes_[j] = 1;
        next.push_back(j);
      });
    });
  }

  /// Nearer to the other plane than to the sheet, by the mean of the surrounding pixels.
  bool is_nearer(const Sheet& other, std::uint32_t pixel, int blur) const {
    const float middle = sheet_.distance_m(grid_.points[pixel]);
    const float most = field_.tolerance_m(sheet_, pixel);
    float to_sheet = 0, to_other = 0;
    for_pixels(grid_, box_around(grid_, pixel, blur), [&](std::uint32_t i) {
      const float d = sheet_.distance_m(grid_.points[i]);
      if (!(std::abs(d - middle) <= most)) return;  // also if not measured
      to_sheet += d;
      to_other += other.distance_m(grid_.points[i]);
    });
    return std::abs(to_other) < std::abs(to_sheet);
  }

  const WandField& field_;
  const LabelGrid& grid_;
  const Sheet& sheet_;
  std::vector<std::uint8_t>& region_;
  std::vector<std::uint8_t> outside_;  // measured, but not in the region
  std::vector<std::uint8_t> goes_;     // to another surface
  std::vector<Sheet> known_;           // other surfaces, from the last tiles
};

}  // namespace

void cut_at_creases(const WandField& field,
                    const Sheet& sheet,
                    const PixelBox& box,
                    std::vector<std::uint8_t>& region) {
  CreaseCut cut(field, sheet, region);
  for (const Tile& tile : contacts_by_tile(field, sheet, box, region))
    if (tile.size() >= kLeastContact_px) cut.cut_at(tile);
  cut.finish();
}

// Color. Depth images are ragged at the borders of objects, color images are not. Border pixels
// with ambiguous depth are assigned to the side whose color nearby is more similar.

namespace {

constexpr int kStrip_px = 3;          // of the border, to each side
constexpr int kAround_px = 6;         // where the colors of the two sides are sampled
constexpr int kLeastColorPixels = 8;  // of each side
constexpr float kContrast = 36;       // between them, of 255 per channel
constexpr float kClearly = 0.6f;      // nearer to one than to the other
constexpr float kDoubtful = 0.6f;     // of the tolerance: beyond it, inner pixels may be wrong

struct MeanColor {
  Vec3f sum = Vec3f::Zero();
  int count = 0;

  void add(const std::uint8_t* rgb) {
    sum += Vec3f(rgb[0], rgb[1], rgb[2]);
    ++count;
  }
  Vec3f value() const { return sum / static_cast<float>(count); }
};

}  // namespace

void settle_border_by_color(const WandField& field,
                            const Sheet& sheet,
                            const PixelBox& box,
                            std::vector<std::uint8_t>& region) {
  const LabelGrid& grid = field.grid;
  const int width = grid.width, height = grid.height;
  std::vector<std::uint8_t> strip(grid.pixels(), 0);
  for (int v = box.v0; v < box.v1; ++v)
    for (int u = box.u0; u < box.u1; ++u) {
      const int i = v * width + u;
      const bool right = u + 1 < width && region[i] != region[i + 1];
      const bool down = v + 1 < height && region[i] != region[i + width];
      if (!right && !down) continue;
      for_pixels(grid, box_around(grid, static_cast<std::uint32_t>(i), kStrip_px),
                 [&](std::uint32_t j) { strip[j] = 1; });
    }
  enum : std::uint8_t { kUnknown, kInside, kOutside };
  std::vector<std::uint8_t> side(grid.pixels(), kUnknown);
  std::vector<std::uint32_t> doubtful;
  for_pixels(grid, box, [&](std::uint32_t i) {
    if (!grid.measured[i]) return;
    const bool in_doubt =
        strip[i] && field.allowed[i] &&
        (region[i] ? !field.lies_on(sheet, i, kDoubtful) : field.lies_on(sheet, i, kLoosely));
    if (in_doubt)
      doubtful.push_back(i);
    else
      side[i] = region[i] ? kInside : kOutside;
  });
  for (const std::uint32_t i : doubtful) {
    MeanColor inside, outside;
    for_pixels(grid, box_around(grid, i, kAround_px), [&](std::uint32_t j) {
      if (side[j] == kInside) inside.add(&grid.color.data[std::size_t{3} * j]);
      if (side[j] == kOutside) outside.add(&grid.color.data[std::size_t{3} * j]);
    });
    if (inside.count < kLeastColorPixels || outside.count < kLeastColorPixels) continue;
    if ((inside.value() - outside.value()).norm() < kContrast) continue;
    const std::uint8_t* rgb = &grid.color.data[std::size_t{3} * i];
    const Vec3f own(rgb[0], rgb[1], rgb[2]);
    const float to_inside = (own - inside.value()).norm();
    const float to_outside = (own - outside.value()).norm();
    if (to_inside < kClearly * to_outside) region[i] = 1;
    if (to_outside < kClearly * to_inside) region[i] = 0;
  }
}

}  // namespace planescope::labels
