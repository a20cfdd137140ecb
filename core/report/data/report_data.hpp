#pragma once

// What a report says, as plain data. The writers (report_files.hpp) turn it into report.json,
// frames.csv and index.html.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/classifiers.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/segment/noise.hpp"
#include "core/report/data/plane_summary.hpp"
#include "core/report/data/region_sample.hpp"
#include "core/report/page/value_histogram.hpp"

namespace planescope::report {

struct Judgement;

/// A plane with the colour that all pictures give it ("#rrggbb").
struct ReportPlane {
  PlaneSummary summary;
  std::string color;
  int color_id = 0;  // of keep_colors()
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
};
/// "frames/000012/report/overlay.jpg" of "frames/000012/pictures/overlay.png".
std::string copy_of(const ReportPicture& picture);
std::string thumbnail_of(const ReportPicture& picture);

/// The noise that was measured, and the thresholds that follow, one metre from the sensor [m].
struct ReportNoise {
  bool estimated = false, by_range = false, of_spreads = false;
  double sigma_m = 0, theta_rms_m = 0, tau_m = 0;
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
  planes::SegmentCounts segment;
  ReportNoise noise;
  std::vector<ReportPlane> planes;
  RegionSample regions;
  std::vector<ValueHistogram> histograms;  // of our own method's decisions
  std::vector<ReportPicture> pictures;
  std::optional<planes::Metrics> metrics;  // where there is ground truth
  planes::FrameTimings timings;
  double reference_ms = 0;  // what reference_work() took just before; 0: not measured
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
  std::string version, commit;                   // of planescope
  bool modified = false;                         // built from a tree that differs from the commit
  std::string command;                           // as it was typed, without what changes no frame
  std::string shard;                             // "2/8": a part of the frames; empty: all
  std::string created_utc;                       // ISO 8601
  std::string renderer;                          // which GL drew; empty where none could
  std::string renderer_error;                    // why none could
  planes::Method method = planes::Method::ours;  // others have no octree, and label no points
  std::string classifier;  // as --classifier named it; empty where there was none
  std::optional<planes::WeightsRecord> weights;  // where it is a network
  bool partial = false;                          // stopped before the end
  std::vector<ReportOption> options;
  std::string case_colors[5];  // "#rrggbb", by Case
  std::vector<ReportRecording> recordings;
  std::shared_ptr<const Judgement> judgement;  // null: held to nothing (judgement.hpp)
};

/// Sums over all frames that were processed.
struct ReportTotals {
  int recordings = 0;
  int frames_asked = 0, frames_done = 0, frames_refused = 0;
  int planes = 0, fewest_planes = 0, most_planes = 0;
  std::uint64_t points = 0, points_on_planes = 0;
  std::optional<planes::Metrics> metrics;  // mean over the frames with ground truth
};
ReportTotals totals_of(const Report& report);
ReportTotals totals_of(const ReportRecording& recording);

/// Everything about a frame but its pictures, metrics and planes' colours. Planes are rounded as
/// report.json has them.
ReportFrame make_report_frame(const Frame& frame,
                              const planes::FrameResult& result,
                              const planes::PipelineOptions& options);

/// Every option that the method takes, with its value, but for the number of threads, which changes
/// nothing; changed: against the defaults of the same profile.
std::vector<ReportOption> make_report_options(const planes::PipelineOptions& options);

}  // namespace planescope::report
