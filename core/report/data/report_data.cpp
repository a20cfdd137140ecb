// Builds the data of a report from frame results: summaries, totals, options and histograms.

#include "core/report/data/report_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/segment/criteria.hpp"
#include "planescope_build_info.h"  // written by cmake/BuildInfo.cmake at every build

namespace planescope::report {
namespace {

std::string in_report_folder(const ReportPicture& picture, const char* ending) {
  const std::filesystem::path pictures = std::filesystem::path(picture.file).parent_path();
  return (pictures.parent_path() / "report" / (picture.name + ending)).generic_string();
}

constexpr int kBins = 40;
constexpr double kRoom = 4;  // bins end at this many thresholds, since close decisions are near it

class HistogramCounter {
 public:
  HistogramCounter(std::string name, double high, double threshold) {
    histogram_.name = std::move(name);
    histogram_.high = high;
    histogram_.threshold = threshold;
    histogram_.counts.resize(kBins + 2);
  }
  void add(double value) {
    const double bin = std::ceil(value * kBins / histogram_.high - 1e-9);
    ++histogram_.counts[static_cast<std::size_t>(bin <= 0 ? 0 : bin <= kBins ? bin : kBins + 1)];
  }
  ValueHistogram histogram() && { return std::move(histogram_); }

 private:
  ValueHistogram histogram_;
};

ValueHistogram outliers(const planes::Octree& octree, const planes::SegmentOptions& options) {
  // The bin width is a whole number.
  const double width = std::max(1.0, std::ceil(kRoom * options.theta_n_out / kBins));
  HistogramCounter counter("n_out", kBins * width, options.theta_n_out);
  for (const planes::OctreeNode& node : octree.nodes)
    if (node.decided != planes::Case::none)
      counter.add(planes::purity_of(node, options.use_labels).n_out);
  return std::move(counter).histogram();
}

ValueHistogram over_limits(const char* name, std::span<const float> values) {
  HistogramCounter counter(name, kRoom, 1);
  for (const float value : values) counter.add(value);
  return std::move(counter).histogram();
}

}  // namespace

std::string copy_of(const ReportPicture& picture) { return in_report_folder(picture, ".webp"); }
std::string thumbnail_of(const ReportPicture& picture) {
  return in_report_folder(picture, ".small.webp");
}

double ReportFrame::time_ratio() const {
  return reference_ms > 0 ? planes::paper_ms(timings) / reference_ms : 0;
}

double ReportFrame::percent_on_planes() const {
  const auto points = static_cast<double>(counts.kept);
  return points > 0 ? 100 * static_cast<double>(points_on_planes) / points : 0;
}

ReportTotals totals_of(const Report& report) {
  ReportTotals totals;
  std::vector<planes::Metrics> metrics;
  for (const ReportRecording& recording : report.recordings) {
    ++totals.recordings;
    totals.frames_asked += recording.frames_asked;
    for (const ReportFrame& frame : recording.frames) {
      if (!frame.refused.empty()) {
        ++totals.frames_refused;
        totals.unreadable |= frame.unreadable;
        if (totals.first_refusal.empty()) totals.first_refusal = frame.refused;
        continue;
      }
      const int planes = static_cast<int>(frame.planes.size());
      const bool first = totals.frames_done == 0;
      totals.fewest_planes = first ? planes : std::min(totals.fewest_planes, planes);
      totals.most_planes = std::max(totals.most_planes, planes);
      ++totals.frames_done;
      totals.planes += planes;
      totals.planes_undecided += frame.planes_undecided;
      totals.points += frame.counts.kept;
      totals.points_on_planes += frame.points_on_planes;
      totals.points_beyond_range += frame.counts.beyond_range;
      if (frame.metrics) metrics.push_back(*frame.metrics);
    }
  }
  if (!metrics.empty()) totals.metrics = planes::mean_of(metrics);
  return totals;
}

int used_depths(const planes::SegmentCounts& counts) {
  int depths = 1;
  for (int c = 1; c <= 4; ++c)
    for (int depth = 0; depth < static_cast<int>(std::size(counts.nodes_per_case_depth[c]));
         ++depth)
      if (counts.nodes_per_case_depth[c][depth] > 0) depths = std::max(depths, depth + 1);
  return depths;
}

ReportFrame make_report_frame(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::FramePlanes& found,
                              const planes::PipelineOptions& options) {
  ReportFrame report;
  report.index = frame.index;
  report.name = frame.name;
  report.timestamp_s = frame.timestamp_s;
  report.gravity = result.gravity;
  report.counts = result.cloud.counts;
  report.voxels = result.voxels.points.size();
  report.segment = result.segmentation.counts;
  report.noise = planes::noise_figures(result.segmentation.noise);
  report.timings = result.timings;
  report.regions = sample_regions(frame, result);
  for (planes::PlaneSummary plane : found.summaries) {
    plane.hull.clear();
    plane.normal = plane.normal.unaryExpr(&rounded);
    plane.centroid = plane.centroid.unaryExpr(&rounded);
    for (double* value :
         {&plane.offset_m, &plane.tilt_deg, &plane.rms_m, &plane.area_m2, &plane.margin})
      *value = rounded(*value);
    report.points_on_planes += plane.points;
    report.planes_h += plane.label == Label::h;
    report.planes_v += plane.label == Label::v;
    report.planes_undecided += plane.undecided;
    report.planes.push_back({std::move(plane), "#888888"});
  }
  const std::vector<Footing> footings = footings_of(found);
  if (footings.size() == report.planes.size()) {
    for (std::size_t k = 0; k < footings.size(); ++k) report.planes[k].footing = footings[k];
    report.terrain = terrain_of(found, options.foot.radius_m > 0);
  }
  return report;
}

std::vector<ReportOption> make_report_options(const planes::PipelineOptions& options) {
  planes::PipelineOptions defaults;
  defaults.segment = planes::profile_options(options.segment.profile);
  std::vector<ReportOption> result;
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (!info.matters(options) || info.name == "threads") continue;
    ReportOption option{info.name, info.unit, info.meaning, info.section, info.get(options), false};
    option.changed = option.value != info.get(defaults);
    result.push_back(std::move(option));
  }
  return result;
}

planes::PipelineOptions options_of(const Report& report, std::vector<std::string>& unknown) {
  planes::PipelineOptions options;
  // The profile first: the others change its values.
  for (const ReportOption& option : report.options)
    if (option.name == "profile") planes::set_option(options, option.name, option.value);
  for (const ReportOption& option : report.options) {
    if (option.name == "profile") continue;
    const bool known = std::ranges::any_of(
        planes::option_table(),
        [&](const planes::OptionInfo& info) { return info.name == option.name; });
    if (known)
      planes::set_option(options, option.name, option.value);
    else
      unknown.push_back(option.name);
  }
  return options;
}

io::RecordingOptions options_of(const ReportRecording& recording) {
  const auto was_typed = [](const std::string& source) { return source.starts_with("option --"); };
  const io::RecordingInfo& info = recording.info;
  const Intrinsics& k = info.intrinsics;
  io::RecordingOptions options;
  options.topic = info.topic;
  if (was_typed(info.intrinsics_source)) options.intrinsics = {k.fx, k.fy, k.cx, k.cy};
  if (was_typed(info.depth_unit_source)) options.depth_unit_m = info.depth_unit_m;
  return options;
}

double ValueHistogram::edge(std::size_t bin) const {
  return high * static_cast<double>(bin) / static_cast<double>(counts.size() - 2);
}

std::uint64_t ValueHistogram::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::vector<ValueHistogram> decision_histograms(const planes::Segmentation& segmentation,
                                                const planes::LimitRatios& limit_ratios,
                                                const planes::SegmentOptions& options) {
  if (segmentation.octree.nodes.empty()) return {};
  return {outliers(segmentation.octree, options), over_limits("planarity", limit_ratios.planarity),
          over_limits("merge_angle", limit_ratios.angle),
          over_limits("merge_distance", limit_ratios.distance)};
}

void add_to(ValueHistogram& sum, const ValueHistogram& part) {
  if (sum.name != part.name || sum.high != part.high || sum.counts.size() != part.counts.size())
    return;
  for (std::size_t bin = 0; bin < part.counts.size(); ++bin) sum.counts[bin] += part.counts[bin];
}

std::string title_of(const ValueHistogram& histogram) {
  if (histogram.name == "n_out") return "Outliers N_out of each node visited";
  if (histogram.name == "planarity") return "Criterion 3: deviation from a plane, over its limit";
  if (histogram.name == "merge_angle") return "Merging: angle to the nearest plane, over its limit";
  if (histogram.name == "merge_distance")
    return "Merging: distance of the nearest plane, over its limit";
  return histogram.name;
}

// ---- Terrain ----

namespace {

std::string mm(double m) { return fmt::format("{:.0f} mm", 1000 * m); }

/// "2 kerbs: 100 mm, 120 mm".
template <typename Thing>
void add(const std::vector<Thing>& things,
         const char* noun,
         const char* separator,
         std::vector<std::string>& all) {
  if (things.empty()) return;
  std::vector<std::string> each;
  for (const Thing& thing : things) each.push_back(text_of(thing));
  all.push_back(fmt::format("{}: {}", counted(things.size(), noun), fmt::join(each, separator)));
}

/// Minor planes have no id.
void add_listed(const planes::LevelPlanes& planes, std::vector<int>& ids) {
  std::ranges::copy_if(planes, std::back_inserter(ids), [](int id) { return id > 0; });
}

FlightFigures figures_of(const planes::Flight& flight) {
  FlightFigures figures{static_cast<int>(flight.steps.size()),
                        flight.seen,
                        flight.rise_m,
                        flight.going_m,
                        flight.width_m,
                        flight.landing,
                        {}};
  add_listed(flight.foot, figures.planes);
  for (const planes::Flight::Step& step : flight.steps) add_listed(step.tread, figures.planes);
  return figures;
}

KerbFigures figures_of(const planes::Kerb& kerb) {
  KerbFigures figures{kerb.rise_m, kerb.nosing.width_m(), {}};
  add_listed(kerb.lower, figures.planes);
  add_listed(kerb.upper, figures.planes);
  return figures;
}

RampFigures figures_of(const planes::SlopingPlane& ramp) {
  return {ramp.plane, ramp.slope_deg, ramp.rise_m, ramp.run_m, ramp.width_m};
}

template <typename Things, typename Figures>
void add_figures(const Things& things, std::vector<Figures>& all) {
  for (const auto& thing : things) all.push_back(figures_of(thing));
}

}  // namespace

std::string text_of(const FlightFigures& flight) {
  const char* const way[] = {"", " up", " down"};
  return fmt::format(
      "{}{}, rise {}, going {}", counted(static_cast<std::size_t>(flight.count), "step"),
      way[static_cast<std::size_t>(flight.seen)], mm(flight.rise_m), mm(flight.going_m));
}
std::string text_of(const KerbFigures& kerb) { return mm(kerb.rise_m); }
std::string text_of(const RampFigures& ramp) { return fmt::format("{:.0f} deg", ramp.slope_deg); }

int Terrain::steps() const {
  int steps = 0;
  for (const FlightFigures& flight : flights) steps += flight.count;
  return steps;
}

std::string Terrain::text() const {
  std::vector<std::string> all;
  add(flights, "flight", " and ", all);
  add(kerbs, "kerb", ", ", all);
  add(ramps, "ramp", ", ", all);
  return fmt::format("{}", fmt::join(all, "; "));
}

std::vector<Footing> footings_of(const planes::FramePlanes& found) {
  std::vector<Footing> footings(found.footholds.size());
  for (std::size_t k = 0; k < footings.size(); ++k) {
    const planes::Foothold& foothold = found.footholds[k];
    Footing& footing = footings[k];
    footing.outline_area_m2 = found.outlines[k].area_m2;
    footing.height_m = found.stairs.height_m[k];
    footing.slope_deg = foothold.surface.slope_deg;
    footing.rough_rms_m = foothold.surface.rough_rms_m;
    footing.rough_step_m = foothold.surface.rough_step_m;
    footing.support = foothold.surface.support;
    footing.clearance_m = foothold.surface.clearance_m;
    for (std::size_t axis = 0; axis < 2; ++axis)
      footing.tilt_sigma_deg[axis] =
          rounded(foothold.certainty.sigma_tilt_rad[axis] * 180 / std::numbers::pi);
    footing.offset_sigma_m = foothold.certainty.sigma_offset_m;
    if (foothold.space)
      footing.foot = {foothold.steppable, foothold.why_not, foothold.space->area_m2,
                      static_cast<int>(foothold.space->pieces.size())};
  }
  return footings;
}

Terrain terrain_of(const planes::Stairs& stairs) {
  Terrain terrain;
  terrain.floor = stairs.floor;
  add_figures(stairs.flights, terrain.flights);
  add_figures(stairs.kerbs, terrain.kerbs);
  add_figures(stairs.ramps, terrain.ramps);
  return terrain;
}

Terrain terrain_of(const planes::FramePlanes& found, bool foot) {
  Terrain terrain = terrain_of(found.stairs);
  if (!foot) return terrain;
  terrain.steppable_area_m2 = 0;
  for (const planes::Foothold& foothold : found.footholds)
    if (foothold.steppable) terrain.steppable_area_m2 += foothold.space->area_m2;
  return terrain;
}

// ---- Samples of regions ----

namespace {

constexpr int kMostRegionSamples = 8192;

}  // namespace

std::vector<int> RegionSample::plane_of() const {
  std::vector<int> result;
  for (const Run& run : runs)
    result.insert(result.end(), static_cast<std::size_t>(run.count), run.plane);
  return result;
}

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of) {
  std::vector<RegionSample::Run> runs;
  for (const int plane : plane_of) {
    if (runs.empty() || runs.back().plane != plane) runs.push_back({plane, 0});
    ++runs.back().count;
  }
  return runs;
}

RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result) {
  const planes::Cloud& cloud = result.cloud;
  const int width =
      frame.is_cloud() ? static_cast<int>(frame.cloud->points.size()) : frame.depth.width;
  const int height = frame.is_cloud() ? 1 : frame.depth.height;
  RegionSample sample;
  const auto measure = [&] {
    sample.columns = (width + sample.step - 1) / sample.step;
    sample.rows = (height + sample.step - 1) / sample.step;
  };
  for (measure(); std::int64_t{sample.columns} * sample.rows > kMostRegionSamples; measure())
    sample.step *= 2;
  std::vector<int> plane_of(static_cast<std::size_t>(sample.columns) * sample.rows, -1);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    const int u = static_cast<int>(cloud.source[i] % width);
    const int v = static_cast<int>(cloud.source[i] / width);
    if (u % sample.step == 0 && v % sample.step == 0)
      plane_of[static_cast<std::size_t>(v / sample.step) * sample.columns + u / sample.step] =
          result.plane_of[i];
  }
  sample.runs = runs_of(plane_of);
  return sample;
}

BuildInfo build_info() {
  return {PLANESCOPE_BUILD_VERSION, PLANESCOPE_BUILD_COMMIT, PLANESCOPE_BUILD_MODIFIED};
}

}  // namespace planescope::report
