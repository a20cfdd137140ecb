// Matches observed planes with tracks, fuses and merges tracks, and records absences.

#include "core/world/tracks/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/planes/evaluate/metrics.hpp"

namespace planescope::world {
namespace {

constexpr int kEnoughToCompare = 200;  // smallest number of cells for evaluating a frame
constexpr double kHidden = 0.5;        // share of the visible cells that hides the rest

std::vector<planes::PolygonRing> rings_on_grid(const planes::Outline& outline, const Track& track) {
  std::vector<planes::PolygonRing> rings;
  const auto add = [&](const planes::PolygonRing& ring) {
    planes::PolygonRing& on_grid = rings.emplace_back();
    for (const Vec2d& p : ring) on_grid.push_back(track.on_grid(outline.world(p)));
  };
  for (const planes::Outline::Part& part : outline.parts) {
    add(part.outer);
    for (const auto& hole : part.holes) add(hole);
    for (const auto& hole : part.unknown) add(hole);
  }
  return rings;
}

double sigma_tilt_deg(const ObservedPlane& plane) {
  const auto& sigmas = plane.certainty.sigma_tilt_rad;
  return std::max(sigmas[0], sigmas[1]) * 180 / std::numbers::pi;
}

double width_m(const ObservedPlane& plane) { return width_of(fit_plane(plane.moments)); }

/// A plane first appears as a strip at the image border, with poorly known tilt. Ignore tilt that
/// moves no point by more than the offset limit.
double free_tilt_deg(double width_m, const TrackOptions& options) {
  constexpr double kMost_deg = 25;
  const double tilt = std::atan2(options.max_offset_m, std::max(width_m, 1e-3) / 2);
  return std::min(kMost_deg, tilt * 180 / std::numbers::pi);
}

/// Largest angle between two planes that may be the same; `width_m`: of the narrower one.
double most_angle_deg(const TrackOptions& options,
                      double sigma_deg,
                      double other_sigma_deg,
                      double width_m) {
  return options.sigmas * std::hypot(sigma_deg, other_sigma_deg) + free_tilt_deg(width_m, options);
}
double most_offset_m(const TrackOptions& options, double sigma_m, double other_sigma_m) {
  return options.max_offset_m + options.sigmas * std::hypot(sigma_m, other_sigma_m);
}

double sigma_m_at(const ObservedPlane& plane, const Vec3d& p) {
  const planes::Certainty& c = plane.certainty;
  const Vec3d d = p - plane.centroid;
  return std::sqrt(squared(c.sigma_offset_m) + squared(c.sigma_tilt_rad[0] * c.axes[0].dot(d)) +
                   squared(c.sigma_tilt_rad[1] * c.axes[1].dot(d)));
}

/// Reason for the absence of a track, if there is no plane at its position.
Absence absence_of(const Visibility& visibility, int least_cells) {
  const int least = std::min(least_cells, visibility.cells);
  if (visibility.in_view < least)
    return visibility.beyond_range > visibility.in_view ? Absence::beyond_range
                                                        : Absence::out_of_view;
  if (visibility.visible() < std::max(least, static_cast<int>((1 - kHidden) * visibility.in_view)))
    return visibility.unmeasured > visibility.hidden ? Absence::not_measured : Absence::occluded;
  if (2 * visibility.through > visibility.visible()) return Absence::seen_through;
  return Absence::not_detected;
}

}  // namespace

int final_track(const std::deque<Track>& tracks, int id) {
  while (id > 0 && tracks[id - 1].state == TrackState::merged) id = tracks[id - 1].merged_into;
  return id;
}

/// A track with its visibility in a frame.
struct Tracker::Candidate {
  Track* track;
  Visibility visibility;
  bool seen = false;
};

std::vector<Track*> Tracker::alive() {
  std::vector<Track*> alive;
  for (Track& track : tracks_)
    if (track.state == TrackState::alive && track.segment == segment_) alive.push_back(&track);
  return alive;
}

Apart Tracker::apart_from(const ObservedFrame& frame,
                          const Candidate& candidate,
                          const ObservedPlane& plane) const {
  if (candidate.visibility.there >= options_.least_cells)
    return apart(candidate.visibility.places, plane.moments);
  return apart(shifted(candidate.track->moments, candidate.track->anchor - frame.camera()),
               plane.moments);
}

TermResult Tracker::compare(const ObservedFrame& frame,
                            const Candidate& candidate,
                            const ObservedPlane& plane) const {
  const Track& track = *candidate.track;
  const double angle = planes::plane_angle_deg(track.fit.normal, plane.normal);
  const double most_angle = most_angle_deg(options_, sigma_tilt_deg(plane), track.sigma_tilt_deg(),
                                           std::min(track.width_m(), width_m(plane)));
  if (angle > most_angle) return {Term::angle_deg, angle, most_angle};
  const Visibility::On& on = candidate.visibility.on[plane.id];
  const Vec3d where = on.cells > 0 ? Vec3d(on.sum / on.cells) : plane.centroid;
  const double gap = apart_from(frame, candidate, plane).rim_m;
  const double most =
      most_offset_m(options_, sigma_m_at(plane, where), track.sigma_m(track.on_grid(where)));
  if (gap > most) return {Term::gap_m, gap, most};
  return {};
}

const FrameOfTracks& Tracker::skip(int frame, double timestamp_s) {
  FrameOfTracks& result = frames_.emplace_back();
  result.frame = frame;
  result.timestamp_s = timestamp_s;
  result.segment = segment_;
  result.has_pose = false;
  return result;
}

const FrameOfTracks& Tracker::add(ObservedFrame& frame) {
  if (const int segment = segment_of(frame.segment); std::exchange(segment_, segment) != segment)
    taken_ = 0;
  if (own_of_known_.empty()) move_to(frame, aligned_pose(frame, alive()));
  FrameOfTracks result;
  result.T_world_camera = frame.T_world_camera;
  result.gravity = frame.gravity;
  result.frame = frame.frame;
  result.timestamp_s = frame.timestamp_s;
  result.track_of.assign(frame.planes.size(), 0);
  const auto minor = std::ranges::find(frame.planes, true, &ObservedPlane::minor);
  result.listed = static_cast<int>(minor - frame.planes.begin());

  std::vector<Candidate> candidates;
  for (Track* track : alive())
    candidates.push_back({track, visibility_of(*track, frame, options_)});
  evaluate_agreement(candidates, result);
  result.set_aside =
      result.compared_cells >= kEnoughToCompare && result.agreement < options_.least_agreement;
  if (result.set_aside && ++aside_ > std::min(options_.most_aside, taken_)) {
    ++begun_, ++segment_;
    taken_ = 0;
    result.set_aside = false;
    candidates.clear();
  }
  result.segment = segment_;
  if (result.set_aside) {
    for (Candidate& c : candidates) record_absence(frame, c, result);
    return frames_.emplace_back(std::move(result));
  }
  aside_ = 0;
  ++taken_;
  for (const Candidate& c : candidates) update_cells(c.visibility);

  match_expected(frame, candidates, result);
  const std::span<const ObservedPlane> planes = frame.planes;
  assign(frame, planes.first(result.listed), candidates, result);
  assign(frame, planes.subspan(result.listed), candidates, result);
  for (Candidate& c : candidates)
    if (!c.seen) record_absence(frame, c, result);
  merge_covered(frame.frame);
  // Only tracks that grew in this frame can touch others for the first time.
  merge_equal(frame.frame, [&](const Track& track) {
    return track.sightings.back().frame == frame.frame && !track.sightings.back().minor;
  });
  for (int& id : result.track_of) id = final_track(tracks_, id);
  end_gone_tracks(frame.frame);
  leave_window(frame);
  return frames_.emplace_back(std::move(result));
}

void Tracker::evaluate_agreement(std::span<const Candidate> candidates,
                                 FrameOfTracks& result) const {
  // Occlusion by known planes is not a contradiction.
  std::vector<int> there_on(result.track_of.size() + 1, 0), hidden_by(there_on.size(), 0);
  int there = 0, through = 0;
  for (const Candidate& c : candidates) {
    there += c.visibility.there;
    through += c.visibility.through;
    for (std::size_t id = 0; id < there_on.size(); ++id) {
      there_on[id] += c.visibility.on[id].cells;
      hidden_by[id] += c.visibility.on[id].hides;
    }
  }
  int hidden = hidden_by[0];
  for (std::size_t id = 1; id < there_on.size(); ++id)
    if (there_on[id] < options_.least_cells) hidden += hidden_by[id];
  result.compared_cells = there + through + hidden;
  if (result.compared_cells > 0)
    result.agreement = static_cast<double>(there) / result.compared_cells;
}

void Tracker::match_expected(const ObservedFrame& frame,
                             std::vector<Candidate>& candidates,
                             FrameOfTracks& result) {
  const auto candidate_of = [&](int known) -> Candidate* {
    const int own = own_of_known_.empty() ? known : own_of_known_[known - 1];
    const int id = final_track(tracks_, own);
    const auto at =
        std::ranges::find_if(candidates, [&](const Candidate& c) { return c.track->id == id; });
    return at == candidates.end() ? nullptr : &*at;
  };
  for (const ObservedPlane& plane : frame.planes) {
    if (plane.known == 0) continue;
    if (!own_of_known_.empty() && own_of_known_[plane.known - 1] == 0) {
      create_track(frame, plane, result);
      own_of_known_[plane.known - 1] = result.track_of[plane.id - 1];
      tracks_.back().known = plane.known;
    } else if (Candidate* const c = candidate_of(plane.known)) {
      c->seen = true;
      result.track_of[plane.id - 1] = c->track->id;
      add_sighting(*c, frame, plane);
    }
  }
  for (const planes::KnownCover& cover : frame.covered) {
    Candidate *const c = candidate_of(cover.covered), *const by = candidate_of(cover.by);
    if (!c || !by || c->seen || !by->seen) continue;
    c->seen = true;
    ++c->track->covered[by->track->id];
    result.covered.push_back(c->track->id);
  }
}

void Tracker::merge_covered(int frame) {
  for (Track* small : alive()) {
    if (small->state != TrackState::alive) continue;
    for (const auto& [id, frames] : small->covered) {
      if (frames < options_.confirm_frames || frames < small->frames_seen) continue;
      Track& large = tracks_[final_track(tracks_, id) - 1];
      if (&large == small || large.state != TrackState::alive) continue;
      Track &into = small->id < large.id ? *small : large,
            &from = small->id < large.id ? large : *small;
      merge(from, into, frame);
      break;
    }
  }
}

void Tracker::assign(const ObservedFrame& frame,
                     std::span<const ObservedPlane> planes,
                     std::vector<Candidate>& candidates,
                     FrameOfTracks& result) {
  if (planes.empty()) return;
  const bool minor = planes.front().minor;
  std::vector<Candidate*> open;  // tracks
  for (Candidate& c : candidates)
    if (!c.seen) open.push_back(&c);
  const std::size_t columns = planes.size();
  std::vector<double> values(open.size() * columns, 0);
  for (std::size_t t = 0; t < open.size(); ++t)
    for (std::size_t p = 0; p < columns; ++p) {
      const ObservedPlane& plane = planes[p];
      if (result.track_of[plane.id - 1] != 0) continue;
      const Candidate& c = *open[t];
      const Visibility::On& on = c.visibility.on[plane.id];
      double& value = values[t * columns + p];
      if (on.cells > 0) {
        const double covered = std::max(1.0, plane.outline.area_m2 / squared(options_.cell_m));
        const double overlap =
            on.cells / std::max(1.0, std::min<double>(c.visibility.visible(), covered));
        if (overlap < options_.least_overlap) continue;
        if (compare(frame, c, plane).failed != Term::none) continue;
        value = on.cells / std::max(1.0, c.visibility.visible() + covered - on.cells);
      } else if (!minor) {
        if (compare(frame, c, plane).failed != Term::none) continue;
        if (!touch(*c.track, plane)) continue;
        value = 1e-6;  // any overlap wins
      }
    }

  const auto give = [&](std::size_t t, std::size_t p) {
    result.track_of[planes[p].id - 1] = open[t]->track->id;
    add_sighting(*open[t], frame, planes[p]);
  };
  const std::vector<int> plane_of =
      planes::best_assignment(values, static_cast<int>(open.size()), static_cast<int>(columns));
  for (std::size_t t = 0; t < open.size(); ++t)
    if (plane_of[t] >= 0) {
      open[t]->seen = true;
      give(t, static_cast<std::size_t>(plane_of[t]));
    }
  if (minor) return;
  // Remaining planes join the track they fit best, as additional parts.
  for (std::size_t p = 0; p < columns; ++p) {
    if (result.track_of[planes[p].id - 1] != 0) continue;
    std::optional<std::size_t> best;
    for (std::size_t t = 0; t < open.size(); ++t) {
      const double value = values[t * columns + p];
      if (value > 0 && (!best || value > values[*best * columns + p])) best = t;
    }
    if (best)
      give(*best, p);
    else
      create_track(frame, planes[p], result);
  }
}

void Tracker::add_sighting(const Candidate& candidate,
                           const ObservedFrame& frame,
                           const ObservedPlane& plane) {
  Track& track = *candidate.track;
  Sighting sighting;
  sighting.frame = frame.frame;
  sighting.plane = plane.id;
  sighting.pixels = static_cast<float>(plane.pixels);
  sighting.normal = plane.normal.cast<float>();
  sighting.centroid = plane.centroid.cast<float>();
  sighting.minor = plane.minor;
  sighting.undecided = plane.undecided;
  sighting.founding = track.sightings.empty();
  if (!sighting.founding) {
    sighting.part = track.sightings.back().frame == frame.frame;
    if (candidate.visibility.on[plane.id].cells >= options_.least_cells)
      sighting.offset_m = static_cast<float>(apart_from(frame, candidate, plane).middle_m);
    sighting.angle_deg =
        static_cast<float>(planes::plane_angle_deg(plane.normal, track.fit.normal));
  }
  if (!sighting.part) ++track.frames_seen;
  track.sightings.push_back(sighting);
  if (plane.minor) return;  // only confirms the track's presence
  track.fuse(plane, frame.camera());
  if (plane.label != Label::unknown) track.label = label_of_normal(track.fit.normal);
  track.cells.fill(rings_on_grid(plane.outline, track),
                   [&](int x, int y) { track.cells.at(x, y).see(); });
}

void Tracker::create_track(const ObservedFrame& frame,
                           const ObservedPlane& plane,
                           FrameOfTracks& result) {
  Track& track = tracks_.emplace_back(options_.cell_m);
  track.id = static_cast<int>(tracks_.size());
  track.segment = segment_;
  track.label = plane.label;
  track.born = frame.frame;
  track.anchor = plane.centroid;
  track.basis = plane_basis(plane.normal);
  add_sighting({&track, {}}, frame, plane);
  result.track_of[plane.id - 1] = track.id;
}

bool Tracker::touch(const Track& track, const ObservedPlane& plane) const {
  const int radius = track.cells.index_of(options_.join_gap_m);
  const Vec2d middle = track.on_grid(plane.centroid);
  bool near = track.cells.is_near(track.cells.index_of(middle.x()),
                                  track.cells.index_of(middle.y()), radius);
  int count = 0;
  track.cells.fill(rings_on_grid(plane.outline, track), [&](int x, int y) {
    if (!near && ++count % 3 == 0) near = track.cells.is_near(x, y, radius);
  });
  return near;
}

void Tracker::record_absence(const ObservedFrame& frame,
                             Candidate& candidate,
                             const FrameOfTracks& result) {
  Track& track = *candidate.track;
  Gap gap;
  gap.first = gap.last = frame.frame;
  gap.why = absence_of(candidate.visibility, options_.least_cells);
  if (result.set_aside) gap.why = Absence::set_aside;
  if (gap.why == Absence::not_detected) {
    const int id = candidate.visibility.most_on();
    if (id > 0 && !frame.planes[id - 1].minor &&
        2 * candidate.visibility.on[id].cells > candidate.visibility.there) {
      gap.why = Absence::not_matched;
      gap.plane = id;
      gap.term = compare(frame, candidate, frame.planes[id - 1]);
      if (gap.term.failed == Term::none) {
        gap.term = {Term::taken, static_cast<double>(result.track_of[id - 1]), 0};
      }
    }
  }
  if (is_miss(gap.why)) ++track.frames_missed;
  // The previous frame is the last one recorded.
  const int before = frames_.empty() ? -1 : frames_.back().frame;
  if (!track.gaps.empty() && track.gaps.back().last == before && track.gaps.back().why == gap.why) {
    track.gaps.back().last = frame.frame;
    ++track.gaps.back().frames;
  } else {
    track.gaps.push_back(gap);
  }
}

void Tracker::consolidate() {
  if (frames_.empty()) return;
  const int last = frames_.back().frame;
  for (segment_ = 0; segment_ <= frames_.back().segment; ++segment_)
    while (merge_equal(last, [](const Track&) { return true; })) {
    }
  segment_ = frames_.back().segment;
}

bool Tracker::merge_equal(int frame, const std::function<bool(const Track&)>& has_grown) {
  const std::vector<Track*> tracks = alive();
  bool any = false;
  for (Track* small : tracks) {
    if (!has_grown(*small)) continue;
    for (Track* large : tracks) {
      if (small == large || small->state != TrackState::alive || large->state != TrackState::alive)
        continue;
      if (small->known > 0 && large->known > 0)
        continue;  // the earlier pass distinguished them with more data
      const double angle = planes::plane_angle_deg(small->fit.normal, large->fit.normal);
      if (angle > most_angle_deg(options_, small->sigma_tilt_deg(), large->sigma_tilt_deg(),
                                 std::min(small->width_m(), large->width_m())))
        continue;
      // Compare where the narrower one is most accurate: elsewhere its tilt dominates.
      const bool is_narrower = small->width_m() < large->width_m();
      const Vec3d where = (is_narrower ? small : large)->centroid();
      const double most = most_offset_m(options_, small->sigma_m(small->on_grid(where)),
                                        large->sigma_m(large->on_grid(where)));
      if (std::abs((is_narrower ? large : small)->distance_m(where)) > most) continue;
      if (apart(large->moments, shifted(small->moments, small->anchor - large->anchor)).rim_m >
          most)
        continue;
      const int radius = large->cells.index_of(options_.join_gap_m);
      bool near = false;
      int count = 0;
      for (const CellMap::Tile& tile : small->cells.tiles()) {
        for (int i = 0; i < CellMap::kSide * CellMap::kSide && !near; ++i) {
          if (!tile.cells[i].present() || ++count % 3 != 0) continue;
          const Vec2d at = large->on_grid(small->on_plane(small->cells.middle(tile, i)));
          near = large->cells.is_near(large->cells.index_of(at.x()), large->cells.index_of(at.y()),
                                      radius);
        }
        if (near) break;
      }
      if (!near) continue;
      Track& into = small->id < large->id ? *small : *large;
      Track& from = small->id < large->id ? *large : *small;
      merge(from, into, frame);
      any = true;
    }
  }
  return any;
}

void Tracker::merge(Track& from, Track& into, int frame) {
  into.absorb(from);
  from.state = TrackState::merged;
  from.merged_into = into.id;
  from.ended = frame;
  from.cells = CellMap(options_.cell_m);
}

void Tracker::leave_window(const ObservedFrame& frame) {
  if (!(options_.window_m > 0)) return;
  const double reach = options_.window_m / 2 + CellMap::kTileRadius * options_.cell_m;
  for (Track* track : alive()) {
    const std::vector<CellMap::Tile> left =
        track->cells.extract_tiles([&](const CellMap::Tile& tile) {
          const Vec3d away = track->on_plane(track->cells.middle(tile)) - frame.camera();
          return away.cwiseAbs().maxCoeff() > reach;
        });
    if (left.empty()) continue;
    for (const CellMap::Tile& tile : left)
      for (const Cell& cell : tile.cells) track->left_m2 += cell.sure() * squared(options_.cell_m);
    if (left_callback_) left_callback_({track->id, frame.frame, outline_of(*track, left)});
    if (track->cells.present() > 0) continue;
    track->state = TrackState::left;
    track->ended = frame.frame;
  }
}

void Tracker::end_gone_tracks(int frame) {
  for (Track* track : alive())
    if (track->cells.present() == 0) {
      track->state = TrackState::gone;
      track->ended = frame;
    }
}

}  // namespace planescope::world
