// Finds likely mistakes in the labels of a frame, and computes label statistics.

#include "core/labels/review/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand_field.hpp"

namespace planescope::labels {
namespace {

constexpr double kOutlierSigmas = 4;
constexpr double kLeastPlanar = 0.5;  // of an unlabeled region; below it, the region is clutter
constexpr double kSameCamera = 1e-3;  // of a focal length or a unit
constexpr double kSameCenter_px = 0.5;
// Ignore strips along the borders of labels: a region needs a pixel this far from any label.
constexpr int kStrip_px = 2;
constexpr std::size_t kSpeck_px = 32;  // smaller parts are specks along ragged edges

/// In square meters unless the area is small.
std::string area_text(double area_m2) {
  return area_m2 < 0.1 ? fmt::format("{:.0f} cm2", 1e4 * area_m2)
                       : fmt::format("{:.2f} m2", area_m2);
}

/// Pixels of a plane and their distances.
struct Surface {
  const LabelPlane& plane;
  PixelSet pixels;
  std::vector<double> distance_m;  // of each pixel from the plane
  std::vector<double> noise_m;     // expected: a good plane's own, and the depth's
  double mean_range_m = 0, area_m2 = 0;
};

Surface measure(const LabelPlane& plane,
                PixelSet pixels,
                const LabelGrid& grid,
                const AuditOptions& options) {
  Surface surface{plane, std::move(pixels), {}, {}};
  for (const std::uint32_t pixel : surface.pixels) {
    const Vec3d point = grid.points[pixel].cast<double>();
    const double range_m = point.norm();
    // Depth errors act along the ray: a plane seen edge-on hardly moves.
    const double slant = grid.is_cloud() ? 1 : std::abs(plane.normal.dot(point)) / range_m;
    const double across = slant * grid.sigma_m[pixel];
    surface.distance_m.push_back(std::abs(plane.normal.dot(point) - plane.offset_m));
    surface.noise_m.push_back(std::hypot(options.max_rms_m / 2, across));
    surface.mean_range_m += range_m / static_cast<double>(surface.pixels.size());
    surface.area_m2 += grid.pixel_area_m2(pixel, &plane.normal);
  }
  return surface;
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

class Audit {
 public:
  Audit(const FrameLabels& labels, const LabelGrid& grid, const AuditOptions& options)
      : labels_(labels), grid_(grid), options_(options) {}

  std::vector<Finding> run() {
    std::vector<PixelSet> pixels(kPlaneIgnore + 1);
    for (std::uint32_t i = 0; i < grid_.pixels(); ++i)
      if (grid_.measured[i]) pixels[labels_.plane.data[i]].push_back(i);
    for (const LabelPlane& plane : labels_.planes) {
      if (pixels[plane.id].empty()) continue;
      const Surface surface = measure(plane, std::move(pixels[plane.id]), grid_, options_);
      check_rms(surface);
      check_outliers(surface);
      check_parts(surface);
      check_area(surface);
      check_class(surface);
    }
    check_camera();
    if (labels_.review_state != "reviewed") check_unlabeled();
    std::stable_sort(findings_.begin(), findings_.end(), [](const Finding& a, const Finding& b) {
      return a.kind != b.kind ? a.kind < b.kind : a.pixels.size() > b.pixels.size();
    });
    return std::move(findings_);
  }

 private:
  const char* sample() const { return grid_.is_cloud() ? "point" : "pixel"; }

  void add(
      FindingKind kind, int plane, PixelSet pixels, double value, double limit, std::string text) {
    const std::uint32_t where = deepest_pixel(pixels, grid_);
    if (plane > 0) text = fmt::format("P{}: ", plane) + text;
    findings_.push_back({kind, plane, where, std::move(pixels), value, limit, std::move(text)});
  }

  void check_rms(const Surface& s) {
    const double value = 1000 * rms(s.distance_m), limit = 1000 * 2 * rms(s.noise_m);
    if (value <= limit) return;
    add(FindingKind::rms, s.plane.id, s.pixels, value, limit,
        fmt::format("RMS {:.1f} mm; expected at most {:.1f} mm at {:.1f} m", value, limit,
                    s.mean_range_m));
  }

  void check_outliers(const Surface& s) {
    PixelSet far;
    for (std::size_t i = 0; i < s.pixels.size(); ++i)
      if (s.distance_m[i] > kOutlierSigmas * s.noise_m[i]) far.push_back(s.pixels[i]);
    const double value =
        100.0 * static_cast<double>(far.size()) / static_cast<double>(s.pixels.size());
    const double limit = 100 * options_.max_outlier_share;
    if (value <= limit) return;
    add(FindingKind::outliers, s.plane.id, std::move(far), value, limit,
        fmt::format("{:.1f} % of its {}s are off the plane; expected at most {:.1f} %", value,
                    sample(), limit));
  }

  void check_parts(const Surface& s) {
    auto parts = parts_apart(s.pixels, grid_, options_.gap_px);
    std::erase_if(parts, [](const PixelSet& part) { return part.size() < kSpeck_px; });
    if (parts.size() < 2) return;
    const auto largest =
        std::max_element(parts.begin(), parts.end(),
                         [](const PixelSet& a, const PixelSet& b) { return a.size() < b.size(); });
    const auto value = static_cast<double>(parts.size());
    parts.erase(largest);
    PixelSet smaller;
    for (const PixelSet& part : parts) smaller.insert(smaller.end(), part.begin(), part.end());
    std::sort(smaller.begin(), smaller.end());
    const std::size_t pixels = smaller.size();
    add(FindingKind::parts, s.plane.id, std::move(smaller), value, 1,
        fmt::format("{:.0f} separate parts; expected 1 ({} {}s in the smaller ones)", value, pixels,
                    sample()));
  }

  void check_area(const Surface& s) {
    const double value = 1e4 * s.area_m2, limit = 1e4 * options_.min_area_m2;
    if (value >= limit) return;
    add(FindingKind::tiny, s.plane.id, s.pixels, value, limit,
        fmt::format("{:.1f} cm2; expected at least {:.1f} cm2", value, limit));
  }

  void check_class(const Surface& s) {
    if (s.plane.label == Label::unknown || !labels_.gravity.known()) return;
    const double up = std::abs(s.plane.normal.dot(labels_.gravity.direction));
    const double tilt_deg = std::acos(std::min(up, 1.0)) * 180 / M_PI;  // 0 level, 90 upright
    const bool is_h = s.plane.label == Label::h;
    const double limit = is_h ? options_.max_class_tilt_deg : 90 - options_.max_class_tilt_deg;
    if (is_h ? tilt_deg <= limit : tilt_deg >= limit) return;
    add(FindingKind::class_normal, s.plane.id, s.pixels, tilt_deg, limit,
        fmt::format("labeled {} and tilted {:.0f} degrees; expected at {} {:.0f}",
                    to_string(s.plane.label), tilt_deg, is_h ? "most" : "least", limit));
  }

  /// Labels store their camera: with another one, planes are elsewhere.
  void check_camera() {
    const Intrinsics &ours = labels_.intrinsics, &k = grid_.intrinsics;
    const auto name = [&](const char* what, double was, double is) {
      findings_.push_back(
          {FindingKind::camera,
           0,
           0,
           {},
           was,
           is,
           fmt::format("drawn with {} {:.6g}, but the frame has {:.6g}", what, was, is)});
    };
    const auto differ = [](double a, double b) {
      return std::abs(a - b) > kSameCamera * std::max(std::abs(a), std::abs(b));
    };
    const double unit = labels_.depth_unit_m;
    if (unit > 0 && grid_.depth_unit_m > 0 && differ(unit, grid_.depth_unit_m))
      name("a depth unit [m] of", unit, grid_.depth_unit_m);
    if (ours.fx == 0 || k.fx == 0) return;
    if (differ(ours.fx, k.fx)) name("fx", ours.fx, k.fx);
    if (differ(ours.fy, k.fy)) name("fy", ours.fy, k.fy);
    if (std::abs(ours.cx - k.cx) > kSameCenter_px) name("cx", ours.cx, k.cx);
    if (std::abs(ours.cy - k.cy) > kSameCenter_px) name("cy", ours.cy, k.cy);
  }

  /// A reviewer has kept a region of similar size without a plane.
  bool is_decided(const PixelSet& region) const {
    return std::ranges::any_of(labels_.review, [&](const ReviewNote& note) {
      return note.kind == DisagreementKind::invented && note.decision == ReviewDecision::keep &&
             2 * std::size_t{note.pixels} >= region.size() &&
             std::ranges::binary_search(region, note.pixel);
    });
  }

  /// Share of a region's pixels on the plane that contains most of them. Small for clutter.
  double share_on_a_plane(const PixelSet& region) const {
    if (!field_) field_.emplace(make_wand_field(grid_, nullptr, {}));
    LocalFitOptions all_alike;
    all_alike.half_px = 10.0 * grid_.width;
    all_alike.most_pixels = 4000;
    if (grid_.is_cloud()) {
      const auto fit = fit_through(*field_, region, all_alike);
      return fit ? fit->share : 0;
    }
    std::vector<std::uint8_t> usable(grid_.pixels(), 0);
    PixelBox box{grid_.width, grid_.height, 0, 0};
    for (const std::uint32_t i : region) {
      usable[i] = 1;
      const int u = static_cast<int>(i) % grid_.width, v = static_cast<int>(i) / grid_.width;
      box = {std::min(box.u0, u), std::min(box.v0, v), std::max(box.u1, u + 1),
             std::max(box.v1, v + 1)};
    }
    const auto fit = fit_around(*field_, usable, box, region[region.size() / 2], all_alike);
    return fit ? fit->share : 0;
  }

  void check_unlabeled() {
    PixelSet labeled, open;
    for (std::uint32_t i = 0; i < grid_.pixels(); ++i) {
      const bool has_label = labels_.plane.data[i] != 0 || labels_.hv.data[i] != 0;
      if (has_label) labeled.push_back(i);
    }
    const auto near = pixels_near(labeled, grid_, kStrip_px);
    for (std::uint32_t i = 0; i < grid_.pixels(); ++i)
      if (grid_.measured[i] && !near[i]) open.push_back(i);
    const double limit = 1e4 * options_.unlabeled_area_m2;
    for (PixelSet& region : connected_parts(grid_, open, 0)) {
      double value = 0;
      for (const std::uint32_t pixel : region) value += 1e4 * grid_.pixel_area_m2(pixel);
      if (value < limit || is_decided(region)) continue;
      const double share = share_on_a_plane(region);
      if (share < kLeastPlanar || share * value < limit) continue;
      const std::size_t pixels = region.size();
      add(FindingKind::unlabeled, 0, std::move(region), value, limit,
          fmt::format("{} without a label ({} {}s); expected less than {}", area_text(1e-4 * value),
                      pixels, sample(), area_text(1e-4 * limit)));
    }
  }

  const FrameLabels& labels_;
  const LabelGrid& grid_;
  const AuditOptions& options_;
  std::vector<Finding> findings_;
  mutable std::optional<WandField> field_;  // created on demand
};

}  // namespace

const char* to_string(FindingKind kind) {
  constexpr const char* kNames[] = {"camera", "rms",          "outliers",  "parts",
                                    "tiny",   "class_normal", "unlabelled"};
  return kNames[static_cast<int>(kind)];
}

bool is_hint(FindingKind kind) {
  return kind == FindingKind::parts || kind == FindingKind::tiny || kind == FindingKind::unlabeled;
}

std::vector<Finding> audit_labels(const FrameLabels& labels,
                                  const LabelGrid& grid,
                                  const AuditOptions& options) {
  return Audit(labels, grid, options).run();
}

LabelStatistics statistics_of(const FrameLabels& labels, const LabelGrid& grid) {
  std::vector<const LabelPlane*> plane_of(kPlaneIgnore + 1, nullptr);
  LabelStatistics statistics;
  for (const LabelPlane& plane : labels.planes) {
    plane_of[plane.id] = &plane;
    ++statistics.planes;
    if (plane.label == Label::h) ++statistics.h;
    if (plane.label == Label::v) ++statistics.v;
  }
  statistics.measured = grid.measured_count;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const std::uint16_t id = labels.plane.data[i];
    const std::uint8_t hv = labels.hv.data[i];
    if (id == kPlaneIgnore || hv == kHvIgnore) {
      ++statistics.ignored;
    } else if (id != 0 || hv != 0) {
      const LabelPlane* plane = plane_of[id];
      ++statistics.labeled;
      statistics.hidden += plane && plane->hidden;
      statistics.labeled_m2 += grid.pixel_area_m2(i, plane ? &plane->normal : nullptr);
    }
  }
  return statistics;
}

}  // namespace planescope::labels
