#pragma once

// Report data as plain structs: of the current run, or of an earlier one that is read back.
// report_json.hpp writes and reads them, report_files.hpp writes the other files.

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

/// Sources of this binary.
struct BuildInfo {
  std::string version;    // "0.2.0"
  std::string commit;     // 40 hex digits, or "unknown" outside a git checkout
  bool modified = false;  // tracked files differed from the commit
};
BuildInfo build_info();

// ---- Terrain in reports: figures of planes.json, without polygons ----

struct FootRoom {
  bool steppable = false;
  std::string why_not;  // empty: steppable
  double area_m2 = 0;   // area available to the foot's center
  int piece_count = 0;  // convex pieces of that area
};

/// Figures of a plane.
struct Footing {
  double outline_area_m2 = 0;
  double height_m = std::nan("");  // above the floor; NaN: not level
  // As in planes::Surface.
  double slope_deg = std::nan("");
  double rough_rms_m = 0, rough_step_m = 0, support = 0, clearance_m = 0;
  double tilt_sigma_deg[2] = {0, 0};  // towards the axis of the longer extent, the shorter
  double offset_sigma_m = 0;

  std::optional<FootRoom> foot;  // if a foot was given
};

struct FlightFigures {
  int count = 0;  // number of steps
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

/// Figures of a frame.
struct Terrain {
  int floor = 0;  // plane, 0 none
  // Area available to a foot's center, over all steppable planes; NaN: no foot was given.
  double steppable_area_m2 = std::nan("");
  std::vector<FlightFigures> flights;  // most steps first
  std::vector<KerbFigures> kerbs;
  std::vector<RampFigures> ramps;

  int steps() const;  // of all flights
  /// "1 flight: 4 steps up, rise 170 mm, going 289 mm; 1 kerb: 120 mm"; empty if there are none.
  std::string text() const;
};

/// One for each plane, by id - 1; empty if there are only summaries.
std::vector<Footing> footings_of(const planes::FramePlanes& found);
/// `foot`: whether a foot was given, so that areas are known.
Terrain terrain_of(const planes::Stairs& stairs);
Terrain terrain_of(const planes::FramePlanes& found, bool foot);

// ---- Frames ----

/// Planes of a sample of a frame's measurements: enough to match its planes with those of another
/// run, and small enough to store.
struct RegionSample {
  struct Run {
    int plane = 0;  // plane id, 0 no plane, -1 not measured or cropped
    int count = 0;
    bool operator==(const Run&) const = default;
  };
  int step = 1;               // every step-th pixel of every step-th row, or point of a cloud
  int columns = 0, rows = 0;  // for a cloud one row
  std::vector<Run> runs;      // row by row

  bool operator==(const RegionSample&) const = default;
  std::vector<int> plane_of() const;  // one per sample
};

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of);
RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result);

/// A plane with its color in all pictures ("#rrggbb").
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

/// A picture of a stage: a PNG beside the page. Two smaller copies for the page are in the frame's
/// folder `report`, named by copy_of() and thumbnail_of().
struct ReportPicture {
  std::string name;           // "overlay", "depth", "labels", "margins", "cases", ...
  std::string title;          // for display
  std::string alt;            // alternative text, for readers who cannot see the picture
  std::string file;           // of the PNG, relative to the report
  int width = 0, height = 0;  // of the PNG [px]
  std::string pixels_sha256;  // of the PNG's pixels (RGB, row by row)
  // For pictures whose copies lack the legend of the PNG: the page shows it as text.
  std::vector<LegendMark> legend;
};
/// "frames/000012/report/overlay.webp" for "frames/000012/pictures/overlay.png".
std::string copy_of(const ReportPicture& picture);
std::string thumbnail_of(const ReportPicture& picture);

/// Distribution of a frame's decisions around their thresholds: counts that add up over frames.
struct ValueHistogram {
  std::string name;  // "n_out", "planarity", "merge_angle", "merge_distance"
  double high = 0;   // end of the bins, which begin at 0
  double threshold = 0;
  /// Values of 0, values in each bin including its upper edge, and finally larger values.
  std::vector<std::uint32_t> counts;

  double edge(std::size_t bin) const;  // upper edge of counts[bin]
  std::uint64_t total() const;
  bool operator==(const ValueHistogram&) const = default;
};

/// Figures of one frame about planes tracked over frames. NaN: unknown.
struct FrameTracks {
  int breaks = 0, swaps = 0;  // that begin in it
  double kept_percent = 0;    // pixels on planes that are also in the next frame
  double normal_jitter_deg = 0, offset_jitter_m = 0;  // while the camera is still
};

/// One frame: its results, or the reason why there are none.
struct ReportFrame {
  int index = 0;
  std::string name;
  double timestamp_s = 0;
  std::string sha256;       // Recording::frame_hash
  std::string refused;      // why the frame was not processed; empty: it was
  bool unreadable = false;  // refused because it is damaged

  Gravity gravity;
  planes::CloudCounts counts;
  std::uint64_t voxels = 0;  // N_d
  std::uint64_t points_on_planes = 0;
  int planes_h = 0, planes_v = 0;  // both 0 if gravity is unknown
  int planes_undecided = 0;
  planes::SegmentCounts segment;
  planes::NoiseFigures noise;
  std::vector<ReportPlane> planes;
  RegionSample regions;
  std::optional<Terrain> terrain;
  std::optional<FrameTracks> tracks;       // if planes were tracked
  std::vector<ValueHistogram> histograms;  // decisions of our own method
  std::vector<ReportPicture> pictures;
  std::optional<planes::Metrics> metrics;  // if there is ground truth
  planes::FrameTimings timings;
  double reference_ms = 0;  // duration of reference_work() just before; 0: not measured

  /// From voxel grid to planes, as a multiple of the reference work; 0: not measured.
  double time_ratio() const;
  double percent_on_planes() const;  // of the kept points; 0 if there are none
};

struct ReportRecording {
  io::RecordingInfo info;
  std::string name;    // last component of the path
  std::string sha256;  // of the file; empty for folders, whose frames have their own
  int frame_count = 0;
  int frames_asked = 0;  // number of frames in the report
  std::vector<ReportFrame> frames;
};

/// An option and the value that was used.
struct ReportOption {
  std::string name, unit, meaning, section, value;
  bool changed = false;  // differs from the profile's default
};

struct Report {
  std::string version, commit;  // of planescope
  bool modified = false;        // built from a tree that differs from the commit
  std::string command;          // as typed, without options that do not affect frames
  std::string shard;            // "2/8": a part of the frames; empty: all
  std::string created_utc;      // ISO 8601
  std::string renderer;         // GL renderer; empty if there was none
  std::string renderer_error;   // why there was none
  std::string method = "ours";  // value of --method; in old reports it may be unknown
  std::string classifier;       // value of --classifier; empty if none
  std::optional<planes::WeightsRecord> weights;  // for networks
  bool partial = false;                          // stopped before the end
  std::vector<ReportOption> options;
  std::string case_colors[5];  // "#rrggbb", by Case
  std::vector<ReportRecording> recordings;
  std::shared_ptr<const Judgement> judgement;  // null: unchecked (judgement.hpp)
  std::filesystem::path baseline;              // in a report read back: its baseline, as typed

  bool is_ours() const { return method == "ours"; }  // others have no octree and no point labels
  std::string weights_sha256() const { return weights ? weights->sha256 : std::string(); }
};

/// Sums over all processed frames, and reasons for refusing others.
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

/// Number of octree depths in a table of its nodes: from the root to the deepest visited node, at
/// least 1.
int used_depths(const planes::SegmentCounts& counts);

/// Everything about a frame except its pictures, metrics and planes' colors. Planes are rounded as
/// in report.json. `found` may contain only summaries; the result then has neither footing nor
/// terrain.
ReportFrame make_report_frame(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::FramePlanes& found,
                              const planes::PipelineOptions& options);

/// Every option of the method with its value, except the number of threads, which changes nothing.
/// changed: relative to the defaults of the same profile.
std::vector<ReportOption> make_report_options(const planes::PipelineOptions& options);

/// Restores the options that make_report_options() wrote. Options of other methods, which it omits,
/// and options that an earlier version lacked get their defaults. `unknown` receives names that
/// this version does not have. Throws Error naming an option with an invalid value.
planes::PipelineOptions options_of(const Report& report, std::vector<std::string>& unknown);

/// Camera options on the command line when the report was made: --intrinsics, --depth-unit.
io::RecordingOptions options_of(const ReportRecording& recording);

/// N_out of the visited nodes, and values relative to their limits (LimitRatios). Equal options
/// give equal bins. Empty if there is no octree.
std::vector<ValueHistogram> decision_histograms(const planes::Segmentation& segmentation,
                                                const planes::LimitRatios& limit_ratios,
                                                const planes::SegmentOptions& options);

/// Adds counts, unless the bins differ.
void add_to(ValueHistogram& sum, const ValueHistogram& part);

/// "Outliers per node N_out", for display.
std::string title_of(const ValueHistogram& histogram);

}  // namespace planescope::report
