// Opens a location in a report: finds its recording and run, and the step at which the window
// starts.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "app/desktop/actions/actions.hpp"
#include "app/desktop/state/session.hpp"
#include "core/debug/explain/compare.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/data/report_json.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

/// Existing paths for a file typed when the report was created: relative to the current folder, to
/// the report's folder and to its parents, where reports are usually started, or beside the report.
/// The report itself is excluded.
std::vector<fs::path> places_of(const fs::path& typed, const fs::path& report) {
  const fs::path folder = fs::absolute(report).parent_path();
  const fs::path name = typed.has_filename() ? typed.filename() : typed.parent_path().filename();
  std::vector<fs::path> places = {typed, folder / typed, folder / name};
  for (fs::path above = folder; above.has_relative_path();) {
    above = above.parent_path();
    places.push_back(above / typed);
  }
  std::erase_if(places, [&](const fs::path& place) {
    std::error_code none;
    return !fs::exists(place, none) || fs::equivalent(place, report, none);
  });
  return places;
}

const report::ReportRecording& recording_of(const report::Report& report,
                                            const report::ReportTarget& target) {
  const auto count = report.recordings.size();
  if (static_cast<std::size_t>(target.recording) > count)
    throw Error(fmt::format("{}: has no r{}; it has {}", target.file.string(), target.recording,
                            counted(count, "recording")));
  return report.recordings[static_cast<std::size_t>(target.recording) - 1];
}

const report::ReportFrame& frame_of(const report::ReportRecording& recording,
                                    const report::ReportTarget& target) {
  std::vector<int> numbers;
  for (const report::ReportFrame& frame : recording.frames) {
    if (target.frame < 0 || frame.index == target.frame) return frame;
    numbers.push_back(frame.index);
  }
  constexpr std::size_t kMost = 12;
  const bool more = numbers.size() > kMost;
  if (more) numbers.resize(kMost);
  throw Error(fmt::format("{}: has no f{}; its frames from {} are {}{}", target.file.string(),
                          std::max(0, target.frame), recording.name, fmt::join(numbers, ", "),
                          more ? ", ..." : ""));
}

/// `file` is the report that contains the frame.
void expect_plane(const report::ReportFrame& frame,
                  const report::ReportTarget& target,
                  const fs::path& file) {
  const char* letters = target.of_baseline ? "was" : "p";
  const auto count = frame.planes.size();
  if (!frame.refused.empty())
    throw Error(fmt::format("{}: has no {}{}: frame {} was rejected: {}", file.string(), letters,
                            target.plane, frame.index, frame.refused));
  if (static_cast<std::size_t>(target.plane) > count)
    throw Error(fmt::format("{}: has no {}{}: frame {} has {}", file.string(), letters,
                            target.plane, frame.index, counted(count, "plane")));
}

void add_note(std::string& note, const std::string& more) {
  note += (note.empty() ? "" : "; ") + more;
}

/// Returns the options of the report's run. Throws Error if they are no longer available; `note`
/// describes possible differences.
planes::PipelineOptions options_from(const report::Report& report,
                                     const fs::path& file,
                                     std::string& note) {
  std::vector<std::string> unknown;
  planes::PipelineOptions options;
  try {
    options = report::options_of(report, unknown);
  } catch (const Error& error) {
    throw Error(file.string() + ": its options cannot be used: " + error.what());
  }
  if (!unknown.empty())
    add_note(note, fmt::format("{} has options that no longer exist: {}", file.filename().string(),
                               fmt::join(unknown, ", ")));
  if (report.weights_sha256().empty() || options.method != planes::Method::ours) return options;
  if (!planes::names_weights_file(options.classifier)) {
    const fs::path shipped =
        app::find_asset("classifier.safetensors", "the weights of classifier gcn are");
    if (sha256_hex_of_file(shipped) != report.weights_sha256())
      add_note(note, fmt::format("the weights of {} differ from those used for {}",
                                 options.classifier, file.filename().string()));
    return options;
  }
  const std::vector<fs::path> places = places_of(options.classifier, file);
  if (places.empty())
    throw Error(fmt::format("{}: its weights {} were not found there, in its folder, or above it",
                            file.string(), options.classifier));
  const auto same = std::ranges::find(places, report.weights_sha256(), sha256_hex_of_file);
  if (same == places.end())
    throw Error(fmt::format("{}: not the weights used for {}: the SHA-256 hashes differ",
                            places[0].string(), file.string()));
  options.classifier = same->string();
  return options;
}

/// Number of the report's frame in the recording, which may have changed since. nullopt if it is a
/// different recording; `why` is the reason.
std::optional<int> number_in(const OpenRecording& open,
                             const report::ReportFrame& frame,
                             const fs::path& report,
                             std::string& why) {
  const int count = open.recording->frame_count();
  if (frame.sha256.empty() && frame.index < count) return frame.index;  // it could not be read
  const FrameIdentity wanted[] = {{frame.index, frame.sha256, frame.name, frame.timestamp_s}};
  const std::optional<int> found =
      frame.sha256.empty() ? std::nullopt : io::find_frames(*open.recording, wanted)[0];
  if (!found)
    why = fmt::format(
        "{}: not the recording used for {}: none of its {} matches frame {}, SHA-256 {}",
        open.path.string(), report.string(), counted(count, "frame"), frame.index, frame.sha256);
  return found;
}

/// A recording that may be the report's.
struct Candidate {
  fs::path path;
  io::RecordingOptions options;
  fs::path label_dir;
};

std::vector<Candidate> candidates_of(const State& state,
                                     const report::ReportRecording& recorded,
                                     const ReportLink& link,
                                     const fs::path& report) {
  std::vector<Candidate> candidates;
  for (const OpenRecording& open : state.document.recordings) {
    const fs::path path = fs::absolute(open.path).lexically_normal();
    if (link.only_given ||
        (path.has_filename() ? path : path.parent_path()).filename() == recorded.name)
      candidates.push_back({open.path, state.document.recording_options, open.label_dir});
  }
  if (link.only_given) return candidates;
  for (const fs::path& path : places_of(recorded.info.path, report))
    candidates.push_back({path, report::options_of(recorded),
                          link.label_dir.value_or(labels::default_label_dir(path))});
  return candidates;
}

/// Opens the first candidate that is the report's recording and returns the frame's number in it.
/// Throws Error.
OpenRecording open_recorded(const State& state,
                            const report::ReportRecording& recorded,
                            const report::ReportFrame& frame,
                            const ReportLink& link,
                            const fs::path& report,
                            int& number) {
  std::string refusal;
  for (Candidate& candidate : candidates_of(state, recorded, link, report)) {
    OpenRecording open{candidate.path, io::open_recording(candidate.path, candidate.options),
                       candidate.label_dir};
    std::string why;
    if (const std::optional<int> found = number_in(open, frame, report, why)) {
      number = *found;
      return open;
    }
    if (refusal.empty()) refusal = why;
  }
  if (!refusal.empty()) throw Error(refusal);
  throw Error(
      fmt::format("{}: its recording {} was not found there, in the report's folder, or above it; "
                  "specify it: planescope view RECORDING --open {}",
                  report.string(), recorded.info.path.string(), report.string()));
}

bool same_options(const planes::PipelineOptions& a, const planes::PipelineOptions& b) {
  return std::ranges::all_of(planes::option_table(), [&](const planes::OptionInfo& info) {
    return info.get(a) == info.get(b) || !info.matters(b);
  });
}

/// A report's baseline.
struct Baseline {
  fs::path file;
  report::Report report;
};

std::optional<Baseline> baseline_of(const report::Report& report,
                                    const ReportLink& link,
                                    const report::ReportTarget& target,
                                    std::string& note) {
  const fs::path& typed = link.baseline.empty() ? report.baseline : link.baseline;
  if (typed.empty()) {
    if (target.of_baseline)
      throw Error(fmt::format(
          "{}: was{} belongs to a baseline, but the report names none; use --baseline FILE",
          target.file.string(), target.plane));
    return {};
  }
  const std::vector<fs::path> places =
      link.baseline.empty() ? places_of(typed, target.file) : std::vector{typed};
  if (places.empty()) {
    if (target.of_baseline)
      throw Error(
          fmt::format("{}: its baseline {} was not found there, in its folder, or above it; use "
                      "--baseline FILE",
                      target.file.string(), typed.string()));
    add_note(note,
             fmt::format("A is not available: the baseline {} was not found; use --baseline FILE",
                         typed.string()));
    return {};
  }
  const fs::path& file = places[0];
  if (file != typed)
    add_note(note, fmt::format("the baseline is {}", file.lexically_normal().string()));
  Baseline baseline{file, report::read_report(file)};
  if (target.of_baseline && baseline.report.created_utc == report.created_utc &&
      baseline.report.command == report.command)
    throw Error(fmt::format("{}: {} was approved as this baseline; was{} belongs to an earlier one",
                            file.string(), target.file.string(), target.plane));
  return baseline;
}

/// Finds the frame in the baseline and the fate of the plane.
void find_fate(const Baseline& baseline,
               const report::Report& report,
               const report::ReportFrame& frame,
               const report::ReportTarget& target,
               ReportPlace& place) {
  const report::ReportComparison comparison = report::compare_reports(baseline.report, report);
  const auto same = std::ranges::find(comparison.frames, &frame, &report::FrameComparison::now);
  const bool usable = same->baseline && same->fate != report::FrameFate::other_input;
  if (target.of_baseline && !usable)
    throw Error(fmt::format("{}: has no was{}: in recording {}, frame {} {}",
                            baseline.file.string(), target.plane, same->recording, frame.index,
                            same->baseline ? "has different input" : "is not in the baseline"));
  if (!usable) return;
  if (target.of_baseline) expect_plane(*same->baseline, target, baseline.file);
  place.baseline = *same->baseline;
  const auto id =
      target.of_baseline ? &report::PlaneComparison::baseline : &report::PlaneComparison::now;
  const auto fate = std::ranges::find(same->planes, target.plane, id);
  if (target.plane > 0 && fate != same->planes.end()) place.fate = *fate;
}

}  // namespace

bool is_report(const std::string& where) {
  using Json = nlohmann::json;
  const std::string path = where.substr(0, where.rfind('#'));
  std::ifstream file = open_to_read(path);
  // A report may be large: keep only its top level.
  const auto keep = [&](int depth, Json::parse_event_t, const Json&) {
    check_depth(depth, path);
    return depth <= 1;
  };
  const Json json = Json::parse(file, keep, false);
  if (!json.is_object() || !json.contains("schema") || !json["schema"].is_string()) return false;
  return json["schema"].get<std::string>().starts_with("planescope.report/");
}

void open_report(State& state, const ReportLink& link) {
  const report::ReportTarget target = report::parse_report_target(link.target);
  const report::Report report = report::read_report(target.file);
  const report::ReportRecording& recording = recording_of(report, target);
  const report::ReportFrame& frame = frame_of(recording, target);
  if (target.plane > 0 && !target.of_baseline) expect_plane(frame, target, target.file);

  auto place = std::make_shared<ReportPlace>();
  place->frame = frame.index;
  place->plane = target.plane;
  place->of_baseline = target.of_baseline;
  place->now = frame;
  const auto baseline = baseline_of(report, link, target, place->note);
  if (baseline) find_fate(*baseline, report, frame, target, *place);
  planes::PipelineOptions options = options_from(report, target.file, place->note);
  options.threads = state.document.options.threads;
  if (baseline) {
    try {
      place->options_a = options_from(baseline->report, baseline->file, place->note);
      place->options_a->threads = options.threads;
    } catch (const Error& error) {
      add_note(place->note, fmt::format("A is not available: {}", error.what()));
    }
  }
  if (place->options_a && same_options(*place->options_a, options) &&
      baseline->report.weights_sha256() == report.weights_sha256())
    add_note(place->note, "A and B are the same: the baseline had these options");
  OpenRecording open = open_recorded(state, recording, frame, link, target.file, place->frame);
  if (place->frame != frame.index)
    add_note(place->note, fmt::format("frame {} in the report is now frame {} of {}", frame.index,
                                      place->frame, open.path.string()));

  take_recording(state, std::move(open), place->frame);
  state.document.options = options;
  state.document.marked.clear();
  ViewState& view = state.view;
  view.flash = view.marking = false;
  view.playing.direction = 0;
  forget_cameras(state);
  view.arrival.reset();
  view.report_place = place;
  view.against = place->options_a ? Against::pinned : Against::nothing;
  if (place->options_a) view.tool_tab = "compare";
  if (target.plane > 0) view.inspector_tab = target.of_baseline ? "point" : "inspector";
}

namespace {

using Voxels = std::vector<std::uint32_t>;

/// Fallback without samples: a disk around the plane's center with the plane's area.
Voxels voxels_about(const planes::PlaneSummary& plane, const debug::Subject& subject) {
  constexpr double kThickness = 0.02;  // [m]
  const double radius2 = std::max(plane.area_m2, 1e-4) / 3.14159;
  Voxels voxels;
  for (std::uint32_t i = 0; i < subject.voxel_count(); ++i) {
    const Vec3d p = subject.prepared.voxels.points[i].cast<double>() +
                    subject.prepared.cloud.origin - plane.centroid;
    if (std::abs(p.dot(plane.normal)) < kThickness && p.squaredNorm() < radius2)
      voxels.push_back(i);
  }
  return voxels;
}

/// Planes of a report and their voxels in run B.
struct Region {
  const report::ReportFrame& frame;
  std::vector<int> planes;
  Voxels voxels = {};
};

/// The voxels of the planes' samples, ascending. `whole` includes all pixels of a sample's cell.
Voxels voxels_of(const Region& region, const debug::Subject& subject, bool whole = false) {
  const auto& [frame, planes, in_b] = region;
  const report::RegionSample& sample = frame.regions;
  if (sample.runs.empty())
    return voxels_about(frame.planes[static_cast<std::size_t>(planes[0]) - 1].summary, subject);
  const Image16& depth = subject.frame.depth;
  const int width = depth.empty() ? static_cast<int>(subject.point_of_source.size()) : depth.width;
  const int height = depth.empty() ? 1 : depth.height;
  const int reach = whole && !depth.empty() ? sample.step : 1;
  const std::vector<int> plane_of = sample.plane_of();
  Voxels voxels;
  for (std::size_t i = 0; i < plane_of.size(); ++i) {
    if (std::ranges::find(planes, plane_of[i]) == planes.end()) continue;
    const int u = static_cast<int>(i % static_cast<std::size_t>(sample.columns)) * sample.step;
    const int v = static_cast<int>(i / static_cast<std::size_t>(sample.columns)) * sample.step;
    for (int y = v; y < std::min(v + reach, height); ++y)
      for (int x = u; x < std::min(u + reach, width); ++x)
        if (const std::uint32_t voxel =
                subject.voxel_of_source(static_cast<std::size_t>(y) * width + x);
            voxel != planes::kNoVoxel)
          voxels.push_back(voxel);
  }
  std::ranges::sort(voxels);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

std::string plane_name_of(std::int32_t plane) { return fmt::format("P{}", plane); }

/// Goes to the step that created the plane.
void go_to_founding(const debug::Run& run, std::int32_t plane, RunArrival& arrival) {
  arrival.plane = run.segmentation.planes[static_cast<std::size_t>(plane) - 1].founded;
  arrival.step = run.timeline.changes_of_plane(arrival.plane).front().step;
}

struct Guide {
  const ReportPlace& place;
  const debug::Run* a;  // null if there is no such run
  const debug::Run& b;

  RunArrival to_plane_of_now() const {
    Region region{place.now, {place.plane}};
    region.voxels = voxels_of(region, *b.subject);
    const std::int32_t plane = debug::plane_of_region(b, region.voxels);
    RunArrival arrival;
    if (plane == 0) {
      arrive_at_loss(region, fmt::format("plane {}", place.plane), arrival);
      arrival.message += ": not found by this version";
      return arrival;
    }
    go_to_founding(b, plane, arrival);
    arrival.message = fmt::format("plane {} is {}", place.plane, plane_name_of(plane));
    if (is(report::PlaneFate::merged)) {
      arrive_at_merge(arrival);
    } else if (b.is_ours()) {
      arrival.message += fmt::format(", created at step {}", arrival.step);
    }
    return arrival;
  }

  RunArrival to_plane_of_baseline() const {
    const debug::Subject& subject = *b.subject;
    Region region{*place.baseline, {place.plane}};
    region.voxels = voxels_of(region, subject);
    const std::int32_t plane = debug::plane_of_region(b, region.voxels);
    const std::string name = fmt::format("the baseline's plane {}", place.plane);
    RunArrival arrival;
    arrival.marked = voxels_of(region, subject, true);
    if (is(report::PlaneFate::merged) && plane > 0) {
      go_to_founding(b, plane, arrival);
      arrival.message = fmt::format("{} is part of {}", name, plane_name_of(plane));
      arrive_at_merge(arrival);
    } else if (is(report::PlaneFate::split) && plane > 0) {
      std::erase_if(region.voxels,
                    [&](std::uint32_t voxel) { return b.segmentation.plane_of[voxel] == plane; });
      arrive_at_loss(
          region, fmt::format("{} was split; {} is its largest part", name, plane_name_of(plane)),
          arrival);
    } else if (plane > 0) {
      go_to_founding(b, plane, arrival);
      arrival.message =
          is(report::PlaneFate::lost) ? "lost in the report, but not by this version: " : "";
      arrival.message += fmt::format("{} is {}", name, plane_name_of(plane));
    } else {
      arrive_at_loss(region, name + " is lost", arrival);
    }
    return arrival;
  }

  bool is(report::PlaneFate fate) const { return place.fate && place.fate->fate == fate; }

  void arrive_at_loss(const Region& region, const std::string& what, RunArrival& arrival) const {
    arrival.message = what;
    const Voxels& voxels = region.voxels;
    if (!voxels.empty()) arrival.voxel = static_cast<std::int32_t>(voxels[voxels.size() / 2]);
    const debug::RegionDecision loss = debug::loss_of_region(b, voxels);
    if (loss.step > 0)
      arrive_at(region, loss, "unassigned at", arrival);
    else
      arrive_at(region, debug::joining_of_region(b, voxels), "merged at", arrival);
  }

  /// Goes to the step that merged the planes.
  void arrive_at_merge(RunArrival& arrival) const {
    Region region{*place.baseline, place.fate->others};
    region.planes.push_back(place.fate->baseline);
    region.voxels = voxels_of(region, *b.subject);
    arrive_at(region, debug::joining_of_region(b, region.voxels), "merged at", arrival);
  }

  /// Goes to the first decision in B that differs from A, or to the first one in A that B never
  /// made. If neither affects more than a tenth of the region, goes to `otherwise`.
  void arrive_at(const Region& region,
                 const debug::RegionDecision& otherwise,
                 const char* verb,
                 RunArrival& arrival) const {
    const auto counts = [](const debug::RegionDecision& decision, const Voxels& voxels) {
      return 10 * decision.points > voxels.size();
    };
    if (a) {
      const debug::RegionDecision in_b = debug::first_difference(b, *a, region.voxels);
      if (counts(in_b, region.voxels))
        return stand_at(in_b, region.voxels, "A and B diverge at", arrival);
      const Voxels there = voxels_of(region, *a->subject);
      const debug::RegionDecision in_a = debug::first_difference(*a, b, there);
      if (counts(in_a, there)) {
        arrival.in_a = true;
        return stand_at(in_a, there, "only A has", arrival);
      }
    }
    if (otherwise.step > 0) stand_at(otherwise, region.voxels, verb, arrival);
  }

  static void stand_at(const debug::RegionDecision& decision,
                       const Voxels& voxels,
                       const char* verb,
                       RunArrival& arrival) {
    arrival.step = decision.step;
    arrival.voxel = decision.voxel;
    arrival.plane = -1;
    const std::string more =
        decision.alike > 1 ? fmt::format(" (one of {})", decision.alike) : std::string();
    arrival.message += fmt::format(": {} step {}{}, {} of {} sampled voxels", verb, decision.step,
                                   more, decision.points, voxels.size());
  }
};

}  // namespace

RunArrival arrival_at(const ReportPlace& place, const debug::Run* a, const debug::Run& b) {
  const Guide guide{place, a, b};
  RunArrival arrival;
  if (place.plane > 0)
    arrival = place.of_baseline ? guide.to_plane_of_baseline() : guide.to_plane_of_now();
  const std::string between = arrival.message.empty() || place.note.empty() ? "" : "; ";
  arrival.message = place.note + between + arrival.message;
  return arrival;
}

}  // namespace planescope::desktop
