// Measures the stability of planes under irrelevant changes and between frames.

#include "core/lab/experiments/steady.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <span>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/report/compare/rules.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::lab {

// ---- Planes of two images ----

Agreement compare_planes_by_pixel(std::span<const std::int32_t> first,
                                  std::span<const std::int32_t> second,
                                  std::span<const std::uint8_t> undecided) {
  assert(first.size() == second.size());
  const planes::TruthOverlap overlap = planes::count_truth_overlap(first, second);
  Agreement result;
  result.partner.assign(static_cast<std::size_t>(overlap.truth), 0);
  for (int s = 1; s <= overlap.found; ++s) result.second_planes += overlap.found_size[s] > 0;
  for (int f = 1; f <= overlap.truth; ++f) {
    if (overlap.truth_size[f] == 0) continue;
    int best = 0;
    double iou = 0;
    for (int s = 1; s <= overlap.found; ++s)
      if (overlap.iou(f, s) > iou) {
        best = s;
        iou = overlap.iou(f, s);
      }
    const bool has_partner = iou > kSteadyPartnerIou;
    const auto count = [&](KeptPlanes& kept) {
      ++kept.planes;
      kept.partners += has_partner;
      if (has_partner) kept.iou_sum += iou;
      if (overlap.truth_size[f] < kBigPlanePixels) return;
      ++kept.big;
      kept.big_lost += !has_partner;
    };
    const auto at = static_cast<std::size_t>(f) - 1;
    count(result.all);
    if (at >= undecided.size() || !undecided[at]) count(result.decided);
    result.changed += iou < kSamePlaneIou;
    if (has_partner) result.partner[at] = best;
  }
  return result;
}

DepthMeters depth_meters(const Frame& frame, double max_range_m) {
  constexpr std::uint16_t kInvalid = 65535;
  DepthMeters depth{frame.intrinsics, {}};
  depth.intrinsics.width = frame.depth.width;
  depth.intrinsics.height = frame.depth.height;
  for (const std::uint16_t counts : frame.depth.data) {
    const double z = counts * frame.depth_unit_m;
    depth.depth_m.push_back(counts == kInvalid || z > max_range_m ? 0 : z);
  }
  return depth;
}

namespace {

bool depths_agree(double first_m, double second_m) {
  return first_m > 0 && second_m > 0 && std::abs(second_m - first_m) < kDepthAgreement * first_m;
}

}  // namespace

std::vector<std::int32_t> warp_planes(std::span<const std::int32_t> first_planes,
                                      const DepthMeters& first,
                                      const DepthMeters& second,
                                      const Pose& T_second_first) {
  constexpr double kNearest_m = 0.1;
  const Intrinsics &from = first.intrinsics, &to = second.intrinsics;
  std::vector<std::int32_t> warped(second.depth_m.size(), -1);
  for (std::size_t i = 0; i < first.depth_m.size(); ++i) {
    const double z = first.depth_m[i];
    if (!(z > 0)) continue;
    const auto u = static_cast<double>(i % from.width), v = static_cast<double>(i / from.width);
    const Vec3d p =
        T_second_first * Vec3d((u - from.cx) / from.fx * z, (v - from.cy) / from.fy * z, z);
    if (!(p.z() > kNearest_m)) continue;
    const double x = std::nearbyint(p.x() / p.z() * to.fx + to.cx);
    const double y = std::nearbyint(p.y() / p.z() * to.fy + to.cy);
    if (!(x >= 0 && x < to.width && y >= 0 && y < to.height)) continue;
    const std::size_t at = static_cast<std::size_t>(y) * to.width + static_cast<std::size_t>(x);
    // If several pixels project to the same one, the last counts.
    if (depths_agree(p.z(), second.depth_m[at])) warped[at] = first_planes[i];
  }
  return warped;
}

std::vector<std::int32_t> planes_in_place(std::span<const std::int32_t> first_planes,
                                          const DepthMeters& first,
                                          const DepthMeters& second) {
  assert(first.depth_m.size() == second.depth_m.size());
  std::vector<std::int32_t> placed(first_planes.begin(), first_planes.end());
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (!depths_agree(first.depth_m[i], second.depth_m[i])) placed[i] = -1;
  return placed;
}

// ---- Measurements ----

namespace {

constexpr double kLeastTurn_deg = 1e-6, kMostTurn_deg = 0.1;
constexpr int kDithers = 3;             // of each frame
constexpr double kDithered = 0.05;      // of the valid pixels
constexpr double kLabelLimit_deg = 45;  // between h and v

/// A row of the table, for each method.
struct SteadyChange {
  SteadyPart part = SteadyPart::gravity;
  std::string name;
  int draws = 1;
  double fx = 1, fy = 1;  // for part focal: factors
};

std::vector<SteadyChange> changes_of(const SteadyJob& job) {
  const std::vector<SteadyChange> all = {
      {SteadyPart::gravity, "gravity turned", job.turns},
      {SteadyPart::focal, "fx x (1 + 1e-7)", 1, 1 + 1e-7, 1},
      {SteadyPart::focal, "fx x (1 + 1e-5)", 1, 1 + 1e-5, 1},
      {SteadyPart::focal, "fx, fy x (1 + 1e-6)", 1, 1 + 1e-6, 1 + 1e-6},
      {SteadyPart::rounded, "intrinsics to 6 digits"},
      {SteadyPart::dither, "dither of 5 %", kDithers},
      {SteadyPart::next, "next frame"}};
  std::vector<SteadyChange> wanted;
  for (const SteadyChange& change : all)
    if (job.parts.contains(change.part)) wanted.push_back(change);
  return wanted;
}

/// Seed of a draw of a frame: the same numbers for every method.
std::uint64_t seed_of(int frame, int draw) {
  return 5 + static_cast<std::uint64_t>(frame) * 1000 + static_cast<std::uint64_t>(draw);
}

/// `gravity`: of the unchanged frame.
void apply(const SteadyChange& change, int draw, const Gravity& gravity, Frame& frame) {
  const std::uint64_t seed = seed_of(frame.index, draw);
  switch (change.part) {
    case SteadyPart::gravity: {
      Random random(seed);
      const double angle_deg =
          std::exp(random.uniform(std::log(kLeastTurn_deg), std::log(kMostTurn_deg)));
      frame.gravity = gravity;
      frame.gravity->direction = turned(gravity.direction, angle_deg, random.uniform(0, 360));
      break;
    }
    case SteadyPart::focal:
      frame.intrinsics.fx *= change.fx;
      frame.intrinsics.fy *= change.fy;
      break;
    case SteadyPart::rounded:
      frame.intrinsics = rounded_to_six_digits(frame.intrinsics);
      break;
    case SteadyPart::dither:
      dither(frame.depth, seed);
      break;
    case SteadyPart::next:
      break;
  }
}

/// The planes of a frame; empty if the method refused it.
struct FoundBySteady {
  std::string refused;
  Gravity gravity;
  std::vector<std::int32_t> plane_of;  // by pixel
  std::vector<planes::PlaneRegion> planes;
  std::vector<std::uint8_t> undecided;  // by id - 1
  report::ReportFrame report;           // if requested
};

FoundBySteady find_planes(const Frame& frame,
                          const planes::PipelineOptions& options,
                          const LibraryRival* rival,
                          const planes::Classifier* classifier,
                          bool with_report) {
  FoundBySteady found;
  found.plane_of.assign(frame.depth.pixels(), 0);
  found.report.index = frame.index;
  try {
    const bool is_ours = options.method == planes::Method::ours;
    const planes::FrameResult result =
        run_method(frame, options, is_ours ? classifier : nullptr, rival);
    for (std::size_t i = 0; i < result.plane_of.size(); ++i)
      found.plane_of[result.cloud.source[i]] = result.plane_of[i];
    found.gravity = result.gravity;
    found.planes = result.segmentation.planes;
    for (const planes::PlaneRegion& plane : found.planes)
      found.undecided.push_back(plane.undecided);
    if (!with_report) return found;
    planes::FramePlanes summaries;
    summaries.summaries = planes::summarize_planes(result, options.cloud.voxel_size_m);
    found.report = report::make_report_frame(frame, result, summaries, options);
  } catch (const Error& error) {
    found.refused = found.report.refused = error.what();
  }
  return found;
}

/// Number of errors by the built-in rules, with `first` as the baseline.
int report_errors(const report::ReportFrame& first, const report::ReportFrame& second) {
  report::Report baseline, now;
  baseline.recordings.resize(1);
  baseline.recordings[0].frames = {first};
  now.recordings.resize(1);
  now.recordings[0].frames = {second};
  const report::ReportComparison comparison = report::compare_reports(baseline, now);
  int errors = 0;
  for (const report::Breach& breach : report::broken_rules(report::built_in_rules(), comparison))
    errors += breach.rule.level == report::RuleLevel::error;
  return errors;
}

double from_limit_deg(const planes::PlaneRegion& plane) {
  return std::abs(planes::plane_angle_deg(plane.fit.normal, Vec3d::UnitZ()) - kLabelLimit_deg);
}

/// `first_plane_of`: the first frame's planes, warped to the second's pixels.
SteadyPair pair_of(const FoundBySteady& first,
                   std::span<const std::int32_t> first_plane_of,
                   const FoundBySteady& second) {
  SteadyPair pair;
  pair.planes = compare_planes_by_pixel(first_plane_of, second.plane_of, first.undecided);
  pair.count_difference =
      static_cast<int>(std::abs(std::ssize(first.planes) - std::ssize(second.planes)));
  for (std::size_t i = 0; i < pair.planes.partner.size(); ++i) {
    const int partner = pair.planes.partner[i];
    if (partner == 0) continue;
    const planes::PlaneRegion& plane = first.planes[i];
    if (plane.label == second.planes[static_cast<std::size_t>(partner) - 1].label) continue;
    ++pair.label_changes;
    pair.label_changes_deg += from_limit_deg(plane);
  }
  return pair;
}

/// A frame with all changes, processed by one method.
class SteadyUnit {
 public:
  SteadyUnit(const SteadyJob& job, const SteadyMethod& method, int frame)
      : job_(job), method_(method), frame_(job.recording->frame(frame)) {
    first_ = find(frame_, method_.options);
  }

  const std::string& refused() const { return first_.refused; }

  /// Empty if the change is impossible.
  std::vector<SteadyPair> measure(const SteadyChange& change) const {
    if (change.part == SteadyPart::next) return next_pairs();
    if (change.part == SteadyPart::gravity && !first_.gravity.known()) return {};
    planes::PipelineOptions options = method_.options;
    if (change.part == SteadyPart::gravity)  // use the frame's gravity
      options.gravity.mode = planes::GravityMode::automatic;
    std::vector<SteadyPair> pairs;
    for (int draw = 0; draw < change.draws; ++draw) {
      Frame changed = frame_;
      apply(change, draw, first_.gravity, changed);
      const FoundBySteady second = find(changed, options);
      pairs.push_back(pair_of(first_, first_.plane_of, second));
      if (wants_reports()) pairs.back().report_errors = report_errors(first_.report, second.report);
    }
    return pairs;
  }

 private:
  bool wants_reports() const {
    return std::ranges::any_of(job_.parts, [](SteadyPart part) {
      return part != SteadyPart::dither && part != SteadyPart::next;
    });
  }

  FoundBySteady find(const Frame& frame, const planes::PipelineOptions& options) const {
    if (job_.stop.stop_requested()) throw Cancelled();
    return find_planes(frame, options, method_.rival, job_.classifier, wants_reports());
  }

  std::vector<SteadyPair> next_pairs() const {
    const int next = frame_.index + 1;
    if (next >= job_.recording->frame_count() || job_.recording->info().damaged.contains(next))
      return {};
    const double range_m = method_.options.cloud.max_range_m;
    const Frame frame = job_.recording->frame(next);
    const DepthMeters depth = depth_meters(frame_, range_m);
    const DepthMeters next_depth = depth_meters(frame, range_m);
    std::vector<std::int32_t> brought;
    if (job_.poses.empty()) {
      brought = planes_in_place(first_.plane_of, depth, next_depth);
    } else {
      const auto& from = job_.poses[static_cast<std::size_t>(frame_.index)];
      const auto& to = job_.poses[static_cast<std::size_t>(next)];
      if (!from || !to || from->segment != to->segment) return {};
      brought = warp_planes(first_.plane_of, depth, next_depth,
                            to->T_world_camera.inverse() * from->T_world_camera);
    }
    return {pair_of(first_, brought, find(frame, method_.options))};
  }

  const SteadyJob& job_;
  const SteadyMethod& method_;
  Frame frame_;
  FoundBySteady first_;
};

}  // namespace

Vec3d turned(const Vec3d& direction, double angle_deg, double around_deg) {
  constexpr double kRad = std::numbers::pi / 180;
  const Vec3d across = Eigen::AngleAxisd(around_deg * kRad, direction) * direction.unitOrthogonal();
  return (Eigen::AngleAxisd(angle_deg * kRad, across) * direction).normalized();
}

Intrinsics rounded_to_six_digits(const Intrinsics& intrinsics) {
  Intrinsics rounded = intrinsics;
  for (double* value : {&rounded.fx, &rounded.fy, &rounded.cx, &rounded.cy}) {
    if (*value == 0) continue;
    const double step = std::pow(10.0, 5 - std::floor(std::log10(std::abs(*value))));
    *value = std::round(*value * step) / step;
  }
  return rounded;
}

void dither(Image16& depth, std::uint64_t seed) {
  Random random(seed);
  for (std::uint16_t& counts : depth.data) {
    const bool is_valid = counts > 2 && counts < 65000;
    if (is_valid && random.uniform() < kDithered)
      counts = static_cast<std::uint16_t>(counts + 2 * random.integer(0, 1) - 1);
  }
}

FramePoses own_poses(const io::Recording& recording) {
  const int count = recording.frame_count();
  FramePoses poses(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    if (const std::optional<Pose> pose = recording.T_world_camera(i))
      poses[static_cast<std::size_t>(i)] = world::CameraPose{.frame = i, .T_world_camera = *pose};
  const bool any = std::ranges::any_of(poses, [](const auto& pose) { return pose.has_value(); });
  return any ? poses : FramePoses();
}

SteadyScores measure_steady(const SteadyJob& job) {
  const io::RecordingInfo& info = job.recording->info();
  if (info.width == 0)
    throw Error(info.path.string() + ": contains point clouds; expected depth images");
  const std::vector<SteadyChange> changes = changes_of(job);
  struct OfUnit {
    std::vector<std::vector<SteadyPair>> pairs;  // by change
    std::string refused;
  };
  const std::size_t methods = job.methods.size(), units = job.frames.size() * methods;
  std::vector<OfUnit> measured(units);
  const auto measure = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    const SteadyMethod& method = job.methods[k % methods];
    const int frame = job.frames[k / methods];
    const SteadyUnit unit(job, method, frame);
    if (!unit.refused().empty())
      measured[k].refused = fmt::format("frame {}, {}: {}", frame, method.name, unit.refused());
    for (const SteadyChange& change : changes)
      measured[k].pairs.push_back(unit.refused().empty() ? unit.measure(change)
                                                         : std::vector<SteadyPair>());
  };
  work_through(static_cast<int>(units), job.threads, measure, job.progress);

  SteadyScores scores;
  for (const OfUnit& unit : measured)
    if (!unit.refused.empty()) scores.refused.push_back(unit.refused);
  if (scores.refused.size() == units)
    throw Error(info.path.string() + ", " + scores.refused.front());
  bool any = false;
  for (std::size_t c = 0; c < changes.size(); ++c)
    for (std::size_t m = 0; m < methods; ++m) {
      SteadyRow& row = scores.rows.emplace_back();
      row.part = changes[c].part;
      row.change = changes[c].name;
      row.method = job.methods[m].name;
      for (std::size_t f = 0; f < job.frames.size(); ++f) {
        std::vector<SteadyPair>& pairs = measured[f * methods + m].pairs[c];
        if (!pairs.empty()) row.frames.push_back({job.frames[f], std::move(pairs)});
      }
      any |= !row.frames.empty();
    }
  if (!any)
    throw Error(info.path.string() +
                ": nothing to measure: part gravity requires a frame with known gravity, and part "
                "next requires two consecutive frames");
  return scores;
}

}  // namespace planescope::lab
