#pragma once

// What a report says, as plain data: of the run that is being made, and of an earlier one that is
// read back. report_json.hpp writes and reads it, report_files.hpp makes the other files of it.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::report {

struct Judgement;

/// What this binary was built from.
struct BuildInfo {
  std::string version;    // "0.2.0"
  std::string commit;     // 40 hex digits, or "unknown" where it was not built from a git checkout
  bool modified = false;  // tracked files differed from the commit
};
BuildInfo build_info();

// ---- What a report keeps of what one can stand on: figures of planes.json, without polygons ----

struct FootRoom {
  bool steppable = false;
  std::string why_not;  // empty: steppable
  double area_m2 = 0;   // where the foot's centre may go
  int piece_count = 0;  // convex, of that area
};

/// Of a plane.
struct Footing {
  double outline_area_m2 = 0;
  double height_m = std::nan("");  // above the floor; NaN: it is not level
  // As planes::Surface has them.
  double slope_deg = std::nan("");
  double rough_rms_m = 0, rough_step_m = 0, support = 0, clearance_m = 0;
  double tilt_sigma_deg[2] = {0, 0};  // towards the axis of the longer extent, the shorter
  double offset_sigma_m = 0;

  std::optional<FootRoom> foot;  // where one was given
};

struct FlightFigures {
  int count = 0;  // of steps
  planes::SeenFrom seen = planes::SeenFrom::unknown;
  double rise_m = 0, going_m = 0, width_m = 0;
  bool landing = false;
  std::vector<int> planes;  // ids of the foot and of the treads, from the lowest
};
/// "4 steps up, rise 170 mm, going 289 mm".
std::string text_of(const FlightFigures& flight);

struct KerbFigures {
  double rise_m = 0, width_m = 0;
  std::vector<int> planes;  // the lower ones, then the upper ones
};
std::string text_of(const KerbFigures& kerb);  // "120 mm"

struct RampFigures {
  int plane = 0;
  double slope_deg = 0, rise_m = 0, run_m = 0, width_m = 0;
};
std::string text_of(const RampFigures& ramp);  // "12 deg"

/// Of a frame.
struct Terrain {
  int floor = 0;  // plane, 0 none
  // Where a foot's centre may go, over all steppable planes; NaN: no foot was given.
  double steppable_area_m2 = std::nan("");
  std::vector<FlightFigures> flights;  // those of most steps first
  std::vector<KerbFigures> kerbs;
  std::vector<RampFigures> ramps;

  int steps() const;  // of all flights
  /// "1 flight: 4 steps up, rise 170 mm, going 289 mm; 1 kerb: 120 mm"; empty where there is
  /// nothing.
  std::string text() const;
};

/// One for each plane, by id - 1; none where only summaries are there.
std::vector<Footing> footings_of(const planes::FramePlanes& found);
/// `foot`: whether one was given, and areas are known.
Terrain terrain_of(const planes::Stairs& stairs);
Terrain terrain_of(const planes::FramePlanes& found, bool foot);

// ---- Frames ----

/// Which plane some of a frame's measurements are on: enough to match its planes with those of
/// another run, and small enough to be kept.
struct RegionSample {
  struct Run {
    int plane = 0;  // plane id, 0 in none, -1 not measured or cropped
    int count = 0;
    bool operator==(const Run&) const = default;
  };
  int step = 1;               // every step-th pixel of every step-th row, or point of a cloud
  int columns = 0, rows = 0;  // of a cloud one row
  std::vector<Run> runs;      // row by row

  bool operator==(const RegionSample&) const = default;
  std::vector<int> plane_of() const;  // one per sample
};

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of);
RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result);

/// A plane with the colour that all pictures give it ("#rrggbb").
struct ReportPlane {
  planes::PlaneSummary summary;
  std::string color;
  int color_id = 0;  // palette index of `color`, from 1
  std::optional<Footing> footing{};
};

/// One entry of a picture's legend.
struct LegendMark {
  std::string shape;  // "dot", "box", "hatched_box", "line", "arrow"
  std::string color;  // "#rrggbb"
  std::string text;
};

/// One picture of a stage: a PNG beside the page. Two smaller copies for the page lie in the
/// frame's folder `report`, as copy_of() and thumbnail_of() name them.
struct ReportPicture {
  std::string name;           // "overlay", "depth", "labels", "margins", "cases", ...
  std::string title;          // for people
  std::string alt;            // what is to be seen, for those who cannot see it
  std::string file;           // of the PNG, relative to the report
  int width = 0, height = 0;  // of the PNG [px]
  std::string pixels_sha256;  // of the PNG's pixels (RGB, row by row)
  // Of pictures whose copies come without the legend that the PNG has, for the page to set as text.
  std::vector<LegendMark> legend;
};
/// "frames/000012/report/overlay.webp" of "frames/000012/pictures/overlay.png".
std::string copy_of(const ReportPicture& picture);
std::string thumbnail_of(const ReportPicture& picture);

/// How near to their thresholds a frame's decisions fell: counts that add up over frames.
struct ValueHistogram {
  std::string name;  // "n_out", "planarity", "merge_angle", "merge_distance"
  double high = 0;   // the bins' end; they begin at 0
  double threshold = 0;
  /// Values of 0, then of each of the bins up to and with its upper edge, at last those above.
  std::vector<std::uint32_t> counts;

  double edge(std::size_t bin) const;  // upper one of counts[bin]
  std::uint64_t total() const;
  bool operator==(const ValueHistogram&) const = default;
};

/// How planes that are followed over frames fare in one of them. NaN: nothing is told of it.
struct FrameTracks {
  int breaks = 0, swaps = 0;  // that begin in it
  double kept_percent = 0;    // of the pixels on planes: their planes are in the next frame too
  double normal_jitter_deg = 0, offset_jitter_m = 0;  // while the camera stands still
};

/// One frame: its results, or why there are none.
struct ReportFrame {
  int index = 0;
  std::string name;
  double timestamp_s = 0;
  std::string sha256;       // Recording::frame_hash
  std::string refused;      // why the frame could not be processed; empty: it was
  bool unreadable = false;  // refused for it is damaged

  Gravity gravity;
  planes::CloudCounts counts;
  std::uint64_t voxels = 0;  // N_d
  std::uint64_t points_on_planes = 0;
  int planes_h = 0, planes_v = 0;  // both 0 where gravity is not known
  int planes_undecided = 0;
  planes::SegmentCounts segment;
  planes::NoiseFigures noise;
  std::vector<ReportPlane> planes;
  RegionSample regions;
  std::optional<Terrain> terrain;
  std::optional<FrameTracks> tracks;       // where planes were followed
  std::vector<ValueHistogram> histograms;  // of our own method's decisions
  std::vector<ReportPicture> pictures;
  std::optional<planes::Metrics> metrics;  // where there is ground truth
  planes::FrameTimings timings;
  double reference_ms = 0;  // what reference_work() took just before; 0: not measured

  /// From voxel grid to planes, as a multiple of the reference work; 0: not measured.
  double time_ratio() const;
  double percent_on_planes() const;  // of the points that were kept; of none 0
};

struct ReportRecording {
  io::RecordingInfo info;
  std::string name;    // the path's last part
  std::string sha256;  // of the file; empty for folders, whose frames have their own
  int frame_count = 0;
  int frames_asked = 0;  // of those, how many the report is about
  std::vector<ReportFrame> frames;
};

/// An option as it was used.
struct ReportOption {
  std::string name, unit, meaning, section, value;
  bool changed = false;  // differs from the profile's default
};

struct Report {
  std::string version, commit;  // of planescope
  bool modified = false;        // built from a tree that differs from the commit
  std::string command;          // as it was typed, without what changes no frame
  std::string shard;            // "2/8": a part of the frames; empty: all
  std::string created_utc;      // ISO 8601
  std::string renderer;         // which GL drew; empty where none could
  std::string renderer_error;   // why none could
  std::string method = "ours";  // as --method has it; one that is read may be no more
  std::string classifier;       // as --classifier named it; empty where there was none
  std::optional<planes::WeightsRecord> weights;  // where it is a network
  bool partial = false;                          // stopped before the end
  std::vector<ReportOption> options;
  std::string case_colors[5];  // "#rrggbb", by Case
  std::vector<ReportRecording> recordings;
  std::shared_ptr<const Judgement> judgement;  // null: held to nothing (judgement.hpp)
  std::filesystem::path baseline;  // of one that is read: what it was held against, as typed

  bool is_ours() const { return method == "ours"; }  // others have no octree, and label no points
  std::string weights_sha256() const { return weights ? weights->sha256 : std::string(); }
};

/// Sums over all frames that were processed, and why others were not.
struct ReportTotals {
  int recordings = 0;
  int frames_asked = 0, frames_done = 0, frames_refused = 0;
  int planes = 0, fewest_planes = 0, most_planes = 0;
  int planes_undecided = 0;
  std::uint64_t points = 0, points_on_planes = 0, points_beyond_range = 0;
  bool unreadable = false;                 // one of the refused frames is damaged
  std::string first_refusal;               // empty: none was refused
  std::optional<planes::Metrics> metrics;  // mean over the frames with ground truth
};
ReportTotals totals_of(const Report& report);

/// How many depths of the octree a table of its nodes needs: from the root to the deepest node that
/// was visited, at least 1.
int used_depths(const planes::SegmentCounts& counts);

/// Everything about a frame but its pictures, metrics and planes' colours. Planes are rounded as
/// report.json has them. Of `found` only the summaries may be there: then there is neither footing
/// nor terrain.
ReportFrame make_report_frame(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::FramePlanes& found,
                              const planes::PipelineOptions& options);

/// Every option that the method takes, with its value, but for the number of threads, which changes
/// nothing; changed: against the defaults of the same profile.
std::vector<ReportOption> make_report_options(const planes::PipelineOptions& options);

/// The options that make_report_options() wrote. Those of other methods, which it leaves out, are
/// the defaults; so is what an earlier version did not have. `unknown`: takes the names that this
/// version does not have. Throws Error naming the option whose value it cannot take.
planes::PipelineOptions options_of(const Report& report, std::vector<std::string>& unknown);

/// What the command line said of the camera when the report was made: --intrinsics, --depth-unit.
io::RecordingOptions options_of(const ReportRecording& recording);

/// N_out of the nodes visited, and values over their limits (LimitRatios). Those of the same
/// options have the same bins. None where there is no octree.
std::vector<ValueHistogram> decision_histograms(const planes::Segmentation& segmentation,
                                                const planes::LimitRatios& limit_ratios,
                                                const planes::SegmentOptions& options);

/// Adds counts; of other bins nothing.
void add_to(ValueHistogram& sum, const ValueHistogram& part);

/// "Outliers per node N_out", for people.
std::string title_of(const ValueHistogram& histogram);

}  // namespace planescope::report
