// Carries labels to another frame, or proposes them in all frames with known poses.

#include "core/labels/review/carry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/labels/edit/operations.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/labels/wand/wand_field.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

constexpr double kSameNoises = 4;  // of depth, within which both frames see the same surface ...
constexpr double kSameLeast_m = 0.015;  // ... and at least this
constexpr int kRefits = 3;
constexpr std::size_t kLeastPixels = 25;  // minimum size of a plane to fit
constexpr double kMostTurn_deg = 20;      // of a plane when it is fitted again
constexpr int kExtend_px = 8;
constexpr double kSamePlane_deg = 10;  // to be the same plane as one with this id
constexpr double kRegistering = 0.7;   // of the whole progress
constexpr double kSpeck_m2 = 0.001;    // smaller parts of a carried plane are dropped
constexpr int kHole_px = 100;          // smaller holes of a carried plane are filled
constexpr std::uint32_t kUnseen = 0xffffffff;

/// Labels of the other frame, projected to each pixel of this one.
struct Expected {
  std::vector<std::uint16_t> plane;
  std::vector<std::uint8_t> hv;
  std::vector<std::uint32_t> seen_at;  // pixel of the other frame that measured the same surface
};

Expected warped(const LabelGrid& from,
                const FrameLabels& labels,
                const LabelGrid& to,
                const Pose& T_from_to) {
  Expected expected{std::vector<std::uint16_t>(to.pixels(), 0),
                    std::vector<std::uint8_t>(to.pixels(), 0),
                    std::vector<std::uint32_t>(to.pixels(), kUnseen)};
  for (std::size_t i = 0; i < to.pixels(); ++i) {
    if (!to.measured[i]) continue;
    const Vec3d point = T_from_to * to.points[i].cast<double>();
    const auto seen = from.pixel_that_sees(point);
    if (!seen || !from.measured[*seen]) continue;
    const std::uint32_t j = *seen;
    const double apart = std::abs(point.norm() - double{from.points[j].norm()});
    const double noise = std::hypot(from.sigma_m[j], to.sigma_m[i]);
    if (apart > std::max(kSameLeast_m, kSameNoises * noise)) continue;
    expected.seen_at[i] = j;
    expected.plane[i] = labels.plane.data[j];
    expected.hv[i] = labels.hv.data[j];
  }
  return expected;
}

/// A plane fitted to the measurements where it is expected; nullopt if there is none.
std::optional<Sheet> fitted(const WandField& field, const Sheet& start, const PixelSet& pixels) {
  const float least_cosine = static_cast<float>(std::cos(kMostTurn_deg * std::numbers::pi / 180));
  Sheet sheet = start;
  for (int k = 0; k < kRefits; ++k) {
    Moments moments;
    for (const std::uint32_t i : pixels)
      if (field.lies_on(sheet, i, k == 0 ? 2 : 1)) moments.add(field.grid.points[i].cast<double>());
    if (moments.count < kLeastPixels) return std::nullopt;
    const auto refitted = sheet_through(moments);
    if (!refitted) return std::nullopt;
    // A strip narrower than its noise determines no direction.
    if (refitted->normal.dot(start.normal) < least_cosine) return start;
    sheet = *refitted;
  }
  return sheet;
}

Sheet moved(const LabelPlane& plane, const Pose& T_to_from) {
  const Vec3d normal = T_to_from.linear() * plane.normal;
  return {normal.cast<float>(),
          static_cast<float>(plane.offset_m + normal.dot(T_to_from.translation()))};
}

/// A plane being carried into the new frame.
struct Carried {
  int id = 0;  // in the old frame
  Sheet sheet;
  std::vector<std::uint8_t> open;  // per pixel of the new frame, 1 if it may extend there
};

class Carrying {
 public:
  Carrying(const LabelGrid& from,
           const LabelGrid& to,
           const FrameLabels& existing,
           const Expected& expected)
      : from_(make_wand_field(from, nullptr, {})),
        to_(to),
        field_(make_wand_field(to, &existing, {})),
        existing_(existing),
        expected_(expected) {
    result_.labels = existing;
    result_.doubt.resize(to.pixels(), 0);
  }

  void carry_plane(const LabelPlane& plane,
                   const Sheet& start,
                   const PixelSet& expected,
                   double min_confidence) {
    CarriedPlane report;
    report.id = plane.id;
    const auto sheet = fitted(field_, start, expected);
    PixelSet on;
    for (const std::uint32_t i : expected)
      if (sheet && field_.lies_on(*sheet, i)) on.push_back(i);
    report.confidence = static_cast<double>(on.size()) / static_cast<double>(expected.size());
    const int id = on.empty() || report.confidence < min_confidence
                       ? 0
                       : place_for(plane, *sheet, report.confidence);
    if (id == 0) on.clear();
    for (const std::uint32_t i : expected) result_.doubt[i] = 1;
    for (const std::uint32_t i : on) paint(i, id);
    report.pixels = on.size();
    report.doubtful = expected.size() - on.size();
    if (id > 0) {
      report.id = id;
      carried_.push_back({id, *sheet, open_to(plane)});
    }
    result_.planes.push_back(report);
  }

  /// Pixels without a plane: a class alone, or "do not score".
  void carry_mark(std::uint32_t pixel, std::uint16_t plane, std::uint8_t hv) {
    result_.labels.plane.data[pixel] = plane;
    result_.labels.hv.data[pixel] = hv;
  }

  /// Extends planes by a few pixels, but not over borders that the labeler drew.
  void extend() {
    std::vector<int> slot(kPlaneIgnore + 1, -1);
    for (std::size_t k = 0; k < carried_.size(); ++k) slot[carried_[k].id] = static_cast<int>(k);
    std::vector<std::uint32_t> front;
    for (std::size_t i = 0; i < to_.pixels(); ++i)
      if (slot[result_.labels.plane.data[i]] >= 0) front.push_back(static_cast<std::uint32_t>(i));
    grow_rings(std::move(front), kExtend_px, [&](std::uint32_t i, auto& next) {
      const Carried& plane = carried_[slot[result_.labels.plane.data[i]]];
      for_pixels(to_, box_around(to_, i, 1), [&](std::uint32_t j) {
        if (!is_free(j) || !plane.open[j] || !field_.lies_on(plane.sheet, j) ||
            !field_.faces(plane.sheet, j))
          return;
        paint(j, plane.id);
        next.push_back(j);
      });
    });
  }

  /// Grows each plane, like the wand would from within its parts, over pixels that the other frame
  /// did not see; then fills small holes, smooths ragged borders and drops specks.
  void grow_and_clean() {
    refit();
    for (const Carried& plane : carried_) {
      std::vector<std::uint8_t> within(to_.pixels(), 0);
      for (std::size_t i = 0; i < to_.pixels(); ++i) within[i] = expected_.seen_at[i] == kUnseen;
      for (const std::uint32_t i : pixels_of_plane(result_.labels, plane.id)) within[i] = 1;
      change(plane.id, grow_to_border(result_.labels, to_, plane.id, {.within = within}));
      change(plane.id, fill_small_holes(result_.labels, to_, plane.id, {}, kHole_px));
      Finish smooth = smooth_border(result_.labels, to_, plane.id, {});
      smooth.takes.clear();  // keep narrow parts as drawn
      change(plane.id, smooth);
      Finish specks = drop_specks(result_.labels, to_, plane.id, kSpeck_m2);
      std::erase_if(specks.takes,
                    [&](std::uint32_t i) { return existing_.plane.data[i] == plane.id; });
      change(plane.id, specks);
    }
  }

  CarriedLabels finish() {
    refit();
    std::ranges::sort(result_.planes, {}, &CarriedPlane::id);
    return std::move(result_);
  }

  bool is_free(std::uint32_t i) const {
    return field_.allowed[i] && result_.labels.plane.data[i] == 0 && result_.labels.hv.data[i] == 0;
  }

 private:
  /// Closed where the other frame saw the plane but has no label: there the labeler drew its
  /// border.
  std::vector<std::uint8_t> open_to(const LabelPlane& plane) const {
    const Sheet sheet{plane.normal.cast<float>(), static_cast<float>(plane.offset_m)};
    std::vector<std::uint8_t> open(to_.pixels(), 0);
    for (std::size_t i = 0; i < to_.pixels(); ++i) {
      const std::uint32_t there = expected_.seen_at[i];
      open[i] = there == kUnseen || expected_.plane[i] == plane.id || !from_.lies_on(sheet, there);
    }
    return open;
  }

  void refit() {
    std::vector<int> ids;
    for (const Carried& plane : carried_) ids.push_back(plane.id);
    if (!ids.empty()) refit_planes(result_.labels, to_, ids);
  }

  void change(int id, const Finish& finish) {
    for (const std::uint32_t i : finish.adds) paint(i, id);
    for (const std::uint32_t i : finish.takes) {
      result_.labels.plane.data[i] = 0;
      result_.labels.hv.data[i] = 0;
    }
  }

  /// Id of a plane in the new frame: its own, if that is free or already the same plane. 0: that
  /// plane is locked.
  int place_for(const LabelPlane& plane, const Sheet& sheet, double confidence) {
    LabelPlane copy = plane;
    if (const LabelPlane* there = find_plane(result_.labels, plane.id)) {
      const double cosine = there->normal.dot(sheet.normal.cast<double>());
      const double apart = std::abs(there->offset_m - sheet.offset_m);
      if (cosine >= std::cos(kSamePlane_deg * std::numbers::pi / 180) &&
          apart <= 4 * field_.options.tolerance_m)
        return there->locked ? 0 : plane.id;
      copy.id = free_plane_id(result_.labels);
    }
    copy.origin = LabelOrigin::carried;
    copy.confidence = confidence;
    copy.locked = false;
    add_plane(result_.labels, copy);
    return copy.id;
  }

  void paint(std::uint32_t i, int id) {
    result_.labels.plane.data[i] = static_cast<std::uint16_t>(id);
    result_.labels.hv.data[i] = static_cast<std::uint8_t>(find_plane(result_.labels, id)->label);
    result_.doubt[i] = 0;
  }

  WandField from_;
  const LabelGrid& to_;
  WandField field_;
  const FrameLabels& existing_;
  const Expected& expected_;
  CarriedLabels result_;
  std::vector<Carried> carried_;
};

/// Throws Error if the motion is unknown and the frames overlap too little to register.
Registration motion_between(const Frame& from_frame,
                            const LabelGrid& from,
                            const Frame& to_frame,
                            const LabelGrid& to,
                            const CarryOptions& options,
                            std::stop_token stop,
                            const std::function<void(double)>& progress) {
  Registration motion;
  if (options.T_to_from) {
    motion.T_to_from = *options.T_to_from;
    return motion;
  }
  motion = register_frames(from, to, std::move(stop), [&](double done) {
    if (progress) progress(kRegistering * done);
  });
  if (motion.fitness < options.min_fitness)
    throw Error(fmt::format(
        "frames {} and {}: only {:.0f} % of the points match; expected at least {:.0f} %; the "
        "frames "
        "overlap too little",
        from_frame.name, to_frame.name, 100 * motion.fitness, 100 * options.min_fitness));
  return motion;
}

}  // namespace

CarriedLabels carry_labels(const Frame& from_frame,
                           const LabelGrid& from,
                           const FrameLabels& labels,
                           const Frame& to_frame,
                           const LabelGrid& to,
                           const FrameLabels& existing,
                           const CarryOptions& options,
                           std::stop_token stop,
                           const std::function<void(double)>& progress) {
  const Registration motion =
      motion_between(from_frame, from, to_frame, to, options, stop, progress);
  const Expected expected = warped(from, labels, to, motion.T_to_from.inverse());
  if (stop.stop_requested()) throw Cancelled();

  Carrying carrying(from, to, existing, expected);
  std::vector<PixelSet> pixels(kPlaneIgnore);
  for (std::size_t i = 0; i < to.pixels(); ++i) {
    const auto pixel = static_cast<std::uint32_t>(i);
    const std::uint16_t plane = expected.plane[i];
    if (!carrying.is_free(pixel)) continue;
    if (plane == 0 || plane == kPlaneIgnore)
      carrying.carry_mark(pixel, plane, expected.hv[i]);
    else
      pixels[plane].push_back(pixel);
  }
  for (const LabelPlane& plane : labels.planes) {
    if (stop.stop_requested()) throw Cancelled();
    if (!pixels[plane.id].empty())
      carrying.carry_plane(plane, moved(plane, motion.T_to_from), pixels[plane.id],
                           options.min_confidence);
  }
  carrying.extend();
  carrying.grow_and_clean();
  CarriedLabels result = carrying.finish();
  result.T_to_from = motion.T_to_from;
  result.method = options.T_to_from ? "poses" : motion.used_color ? "RGB-D odometry" : "ICP";
  result.fitness = motion.fitness;
  result.rms_m = motion.rms_m;
  if (progress) progress(1);
  return result;
}

namespace {

/// A frame to carry labels from.
struct Source {
  SpreadFrame at;
  Pose T_world_camera = Pose::Identity();
};

/// The labels of planes that are missing in `labels`.
FrameLabels without_those_of(const FrameLabels& all, const FrameLabels& labels) {
  LabelDraft rest(all);
  for (const LabelPlane& plane : labels.planes)
    if (find_plane(rest.labels, plane.id)) remove_plane(rest, plane.id);
  return rest.labels;
}

class Spreading {
 public:
  explicit Spreading(const SpreadJob& job) : job_(job) {
    const auto pose = job.T_world_camera(job.from);
    if (!pose) throw Error(fmt::format("frame {} has no pose", job.from));
    first_ = {job.open(job.from), *pose};
    if (first_.at.labels.planes.empty())
      throw Error(fmt::format("frame {} has no planes to propose", job.from));
  }

  std::vector<Proposal> run() {
    for (const int direction : {1, -1}) {
      Source before = first_;
      for (int i = job_.from + direction; i >= 0 && i < job_.frames; i += direction) {
        if (job_.stop.stop_requested()) throw Cancelled();
        if (auto here = propose(before, i)) before = std::move(*here);
        if (job_.progress) job_.progress(++done_, job_.frames - 1);
      }
    }
    std::ranges::sort(proposals_, {}, [](const Proposal& proposal) { return proposal.edit.frame; });
    return std::move(proposals_);
  }

 private:
  /// The frame with its proposal; nullopt if it cannot be labeled.
  std::optional<Source> propose(const Source& before, int frame) {
    const auto pose = job_.T_world_camera(frame);
    if (!pose) return std::nullopt;
    Source here;
    here.T_world_camera = *pose;
    try {
      here.at = job_.open(frame);
    } catch (const Error&) {
      return std::nullopt;  // open() reports the reason
    }
    std::size_t doubtful = 0;
    FrameLabels labels = carry(before, here, before.at.labels, here.at.labels, doubtful);
    const FrameLabels unseen = without_those_of(first_.at.labels, labels);
    if (&before != &first_ && !unseen.planes.empty())
      labels = carry(first_, here, unseen, labels, doubtful);
    Proposal proposal =
        proposal_of(make_edit(frame, fmt::format("Propose labels of frame {}", job_.from),
                              here.at.labels, labels),
                    here.at.labels);
    proposal.doubtful = doubtful;
    if (!proposal.edit.empty()) proposals_.push_back(std::move(proposal));
    here.at.labels = std::move(labels);
    return here;
  }

  FrameLabels carry(const Source& from,
                    const Source& to,
                    const FrameLabels& labels,
                    const FrameLabels& existing,
                    std::size_t& doubtful) const {
    CarryOptions options;
    options.T_to_from = to.T_world_camera.inverse() * from.T_world_camera;
    const CarriedLabels carried = carry_labels(from.at.frame, from.at.grid, labels, to.at.frame,
                                               to.at.grid, existing, options, job_.stop);
    for (const CarriedPlane& plane : carried.planes) doubtful += plane.doubtful;
    return carried.labels;
  }

  const SpreadJob& job_;
  Source first_;
  std::vector<Proposal> proposals_;
  int done_ = 0;
};

}  // namespace

Proposal proposal_of(LabelEdit edit, const FrameLabels& before) {
  Proposal proposal;
  proposal.edit = std::move(edit);
  proposal.blank = before;
  proposal.blank.planes.clear();
  proposal.blank.review.clear();
  proposal.blank.plane = Image16();
  proposal.blank.hv = Image8();
  return proposal;
}

std::vector<Proposal> spread_labels(const SpreadJob& job) { return Spreading(job).run(); }

}  // namespace planescope::labels
