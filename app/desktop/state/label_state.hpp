#pragma once

// The label mode in plain data: the frame as labels are drawn on it, tools, and what jobs found.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/io/recording.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/edit/selection.hpp"
#include "core/labels/review/audit.hpp"
#include "core/labels/review/carry.hpp"
#include "core/labels/review/review.hpp"
#include "core/labels/store/store.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "render/draw_list.hpp"

namespace planescope::desktop {

/// Work that the state asks for and a job does.
struct Asked {
  bool running = false, begun = false;  // begun: the job knows of it
  int done = 0, total = 0;
  std::string stage = {};  // what is done of what
};

/// What the window is for at the moment: other panels, other keys.
enum class Mode : std::uint8_t { debugger, labels };

/// A frame made ready for labeling, by a job.
struct LabelFrame {
  std::shared_ptr<const io::Recording> recording;
  int frame = 0;
  std::string sha256;  // Recording::frame_hash
  labels::LabelGrid grid;
  Pose T_world_sensor = Pose::Identity();
  std::vector<Vec3f> world;  // per pixel, as the scene draws it [m]; NaN where not measured
};

/// Labels and algorithm side by side, of one version of both.
struct ReviewQueue {
  std::shared_ptr<const FrameLabels> labels;
  std::shared_ptr<const debug::Run> run;  // null: with another annotator
  std::string other;                      // "refined", or the folder of another annotator
  std::shared_ptr<const labels::OtherLabels> other_labels;
  std::vector<labels::Disagreement> items;     // undecided first, then by area
  double smallest_cm2 = 0;                     // of them
  std::optional<labels::Agreement> agreement;  // with another annotator
  bool labels_decided = false;                 // and changed by that: the queue after it goes on

  std::size_t undecided() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(items, [](const labels::Disagreement& item) { return !item.note; }));
  }
};

/// What looks wrong in the labels of a frame.
struct Audit {
  std::vector<labels::Finding> findings;
};

/// Labels being carried to the frame looked at.
struct CarryJob {
  bool running = false, begun = false;  // begun: the job knows of it
  int from = 0;
  int left = 0;            // frames to go after this one
  double least_share = 0;  // a plane less sure than that ends it; 0: none does
  int gone = 0;            // frames that it went over, this one not among them
  std::shared_ptr<const LabelFrame> from_frame;
  std::shared_ptr<const FrameLabels> from_labels;
  double progress = 0;
  std::shared_ptr<const labels::CarriedLabels>
      done;  // its doubt is shown until Escape or another frame
};

/// Labels of one frame, on their way into all frames that see its planes.
struct SpreadWork : Asked {
  int from = 0;   // the frame whose labels are proposed, unless a track is:
  int track = 0;  // of the map; 0: none
  std::vector<std::pair<int, double>> doubtful;  // frames it came to, by how much is left open
};

/// How long to learn, and beside how many synthetic clouds of each kind at most.
struct Lesson {
  int steps = 1000;
  int clouds = 200;
};

/// Points labelled right on frames that were not learnt from: by the weights that ship, and by
/// those that learnt.
struct Gain {
  std::size_t frames = 0;
  planes::LabelAccuracy before, after;
};
/// What weights beside the labels have learnt.
struct Learnt {
  int steps = 0;
  std::size_t frames = 0;  // that were there to learn from, those kept aside among them
  Gain kept, since;        // on those; on frames that were reviewed since
};

/// A classifier that learns from reviewed frames.
struct Learning {
  struct Training : Asked {
    Lesson lesson;
  } training;
  std::shared_ptr<const Learnt> learnt;  // null: there are no such weights, or not yet measured
  std::string refusal;                   // why they cannot be measured, one line
  struct Doubt : Asked {
    std::vector<std::optional<double>> of_frame;  // doubt_of(); empty: not looked for
  } doubt;
};

/// What the label folder has of a frame.
struct FrameMark {
  bool labelled = false, reviewed = false;
};

struct LabelResults {
  std::shared_ptr<const LabelFrame> frame;  // check State::label_frame()
  std::string refusal;                      // why the frame cannot be labelled, one line
  std::shared_ptr<const ReviewQueue> review;
  std::string review_refusal;  // why there is nothing to compare with, one line
  std::shared_ptr<const Audit> audit;
  std::vector<labels::WorkTime> work;  // of all frames, with `audit`
  std::vector<FrameMark> marks;  // by frame, as the mode was entered; frames at hand know better
  std::string save_problem;      // why the label files could not be written last, one line
  CarryJob carry;
  SpreadWork spread;
  Learning learning;
};

enum class LabelTool : std::uint8_t { wand, brush, rectangle, lasso, polygon, cut };
enum class DrawnIn : std::uint8_t { image, space };
/// What strokes leave behind.
enum class Paints : std::uint8_t { plane, ignore, erase, h_only, v_only };

/// A wand preview: what `Enter` would make a plane.
struct WandPreview {
  std::vector<std::uint32_t> seeds;
  bool onto_active = false;                         // it joins the active plane instead
  std::shared_ptr<const labels::WandResult> found;  // null: `why_not` says why
  std::string why_not;
};

/// The points of a frame as a view in space shows them.
struct SpaceSight {
  std::shared_ptr<const LabelFrame> frame;
  std::shared_ptr<const FrameLabels> labels;  // that say what is hidden
  std::vector<std::uint8_t> shown;
  render::Camera camera;
  labels::SeenPoints points;
};

/// A polygon, corner by corner; closed by Enter.
struct OpenPolygon {
  DrawnIn where = DrawnIn::image;
  labels::PaintMode mode = labels::PaintMode::over;
  std::vector<labels::Vec2f> corners;  // depth pixels; in space, pixels of a view of `view_size`
  labels::Vec2f view_size = labels::Vec2f::Zero();  // in space
  render::Camera camera;                            // in space: it is let go of where that moves
};

/// The lasso that the wand stays in.
struct WandBound {
  OpenPolygon drawn;                 // closed
  std::vector<std::uint8_t> within;  // per pixel
};

struct LabelView {
  LabelTool tool = LabelTool::wand;
  Paints paints = Paints::plane;
  int plane = 0;         // the active one; 0: a new plane with the next gesture
  double brush_px = 10;  // radius, in pixels of the view or depth pixels of the image
  bool through = false;  // strokes in space take hidden points too
  labels::WandOptions wand_options;
  WandPreview wand;
  std::shared_ptr<const WandBound> bound;           // null: the wand takes what it finds anywhere
  std::shared_ptr<const labels::LabelEdit> finish;  // shown first, committed by Enter
  std::shared_ptr<const labels::LabelEdit> stroke;  // being drawn; planes are not fitted
  std::optional<OpenPolygon> polygon;
  std::shared_ptr<const SpaceSight> sight;  // of the latest gesture in space
  std::int64_t hover = -1;                  // pixel under the mouse in either view; -1: none
  std::size_t hover_hidden = 0;             // points under the brush in space that are not visible
  bool show_class = false;                  // colours by h and v instead of by plane
  bool show_residual = false;               // colours by distance to the active plane
  std::string tab = "planes";               // planes | review | checks | statistics | learning
  std::string compare_with;        // the review's other side: empty: the run, else a label folder
  double review_smallest_cm2 = 5;  // regions below it are left out of the review
  int review_item = -1;            // of the queue
  bool review_slivers = false;     // listed one by one
  int finding = -1;                // of the audit
};

}  // namespace planescope::desktop
