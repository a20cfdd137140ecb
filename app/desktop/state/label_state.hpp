#pragma once

// Label mode as plain data: the frame being labeled, tools, and results of jobs.

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

/// Work that the state requests and a job performs.
struct Asked {
  bool running = false, begun = false;  // begun: a job has started it
  int done = 0, total = 0;
  std::string stage = {};  // name of the current stage
};

/// The mode of the window, which determines its panels and keys.
enum class Mode : std::uint8_t { debugger, labels };

/// A frame prepared for labeling by a job.
struct LabelFrame {
  std::shared_ptr<const io::Recording> recording;
  int frame = 0;
  std::string sha256;  // Recording::frame_hash
  labels::LabelGrid grid;
  Pose T_world_sensor = Pose::Identity();
  std::vector<Vec3f> world;  // per pixel, in scene coordinates [m]; NaN where not measured
};

/// Disagreements between labels and the algorithm, for one version of both.
struct ReviewQueue {
  std::shared_ptr<const FrameLabels> labels;
  std::shared_ptr<const debug::Run> run;  // null when comparing with another annotator
  std::string other;                      // "refined", or the other annotator's folder
  std::shared_ptr<const labels::OtherLabels> other_labels;
  std::vector<labels::Disagreement> items;     // undecided first, then by area
  double smallest_cm2 = 0;                     // area of the smallest item
  std::optional<labels::Agreement> agreement;  // with another annotator
  bool labels_decided = false;                 // a decision changed the labels; continue after it

  std::size_t undecided() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(items, [](const labels::Disagreement& item) { return !item.note; }));
  }
};

/// Suspicious labels of a frame.
struct Audit {
  std::vector<labels::Finding> findings;
};

/// Labels being carried to the current frame.
struct CarryJob {
  bool running = false, begun = false;  // begun: a job has started it
  int from = 0;
  int left = 0;            // frames left after this one
  double least_share = 0;  // stop at a plane with lower confidence; 0: never
  int gone = 0;            // frames carried over so far, without this one
  std::shared_ptr<const LabelFrame> from_frame;
  std::shared_ptr<const FrameLabels> from_labels;
  double progress = 0;
  std::shared_ptr<const labels::CarriedLabels>
      done;  // its confidence is shown until Escape or another frame
};

/// Labels of one frame being proposed for all frames that see its planes.
struct SpreadWork : Asked {
  int from = 0;   // frame whose labels are proposed, unless `track` is set
  int track = 0;  // of the map; 0: none
  std::vector<std::pair<int, double>> doubtful;  // frames reached, with their open fraction
};

/// Training length, and the maximum number of synthetic clouds of each kind.
struct Lesson {
  int steps = 1000;
  int clouds = 200;
};

/// Accuracy on frames that were not used for training: bundled weights against trained weights.
struct Gain {
  std::size_t frames = 0;
  planes::LabelAccuracy before, after;
};
/// Training record of the weights beside the labels.
struct Learnt {
  int steps = 0;
  std::size_t frames = 0;  // labeled frames available, including held-out ones
  Gain kept, since;        // on held-out frames; on frames reviewed since the training
};

/// A classifier trained on reviewed frames.
struct Learning {
  struct Training : Asked {
    Lesson lesson;
  } training;
  std::shared_ptr<const Learnt> learnt;  // null: no such weights, or not evaluated yet
  std::string refusal;                   // why evaluation failed, one line
  struct Doubt : Asked {
    std::vector<std::optional<double>> of_frame;  // doubt_of(); empty: not computed
  } doubt;
};

/// State of a frame in the label folder.
struct FrameMark {
  bool labeled = false, reviewed = false;
};

struct LabelResults {
  std::shared_ptr<const LabelFrame> frame;  // check State::label_frame()
  std::string refusal;                      // why the frame cannot be labeled, one line
  std::shared_ptr<const ReviewQueue> review;
  std::string review_refusal;  // why there is nothing to compare with, one line
  std::shared_ptr<const Audit> audit;
  std::vector<labels::WorkTime> work;  // of all frames, computed with `audit`
  std::vector<FrameMark> marks;        // by frame, as of entering label mode
  std::string save_problem;            // why label files could not be saved, one line
  CarryJob carry;
  SpreadWork spread;
  Learning learning;
};

enum class LabelTool : std::uint8_t { wand, brush, rectangle, lasso, polygon, cut };
enum class DrawnIn : std::uint8_t { image, space };
/// Effect of strokes.
enum class Paints : std::uint8_t { plane, ignore, erase, h_only, v_only };

/// A wand preview: the plane that `Enter` would create.
struct WandPreview {
  std::vector<std::uint32_t> seeds;
  bool onto_active = false;                         // joins the active plane instead
  std::shared_ptr<const labels::WandResult> found;  // null: see `why_not`
  std::string why_not;
};

/// Points of a frame visible in the 3D view.
struct VisiblePoints {
  std::shared_ptr<const LabelFrame> frame;
  std::shared_ptr<const FrameLabels> labels;  // the labels that determine hidden points
  std::vector<std::uint8_t> shown;
  render::Camera camera;
  labels::SeenPoints points;
};

/// A polygon, corner by corner; closed by Enter.
struct OpenPolygon {
  DrawnIn where = DrawnIn::image;
  labels::PaintMode mode = labels::PaintMode::over;
  std::vector<labels::Vec2f> corners;  // depth pixels; in 3D, pixels of a view of `view_size`
  labels::Vec2f view_size = labels::Vec2f::Zero();  // in 3D
  render::Camera camera;                            // in 3D: dropped if it moves
};

/// The lasso that limits the wand.
struct WandBound {
  OpenPolygon drawn;                 // closed
  std::vector<std::uint8_t> within;  // per pixel
};

struct LabelView {
  LabelTool tool = LabelTool::wand;
  Paints paints = Paints::plane;
  int plane = 0;         // active plane; 0: the next gesture creates one
  double brush_px = 10;  // radius, in pixels of the view or depth pixels of the image
  bool through = false;  // strokes in 3D include hidden points
  labels::WandOptions wand_options;
  WandPreview wand;
  std::shared_ptr<const WandBound> bound;           // null: the wand is unlimited
  std::shared_ptr<const labels::LabelEdit> finish;  // preview, committed by Enter
  std::shared_ptr<const labels::LabelEdit> stroke;  // in progress; planes are not fitted yet
  std::optional<OpenPolygon> polygon;
  std::shared_ptr<const VisiblePoints> visible;  // of the latest gesture in 3D
  std::int64_t hover = -1;                       // pixel under the mouse in either view; -1: none
  std::size_t hover_hidden = 0;                  // hidden points under the brush in 3D
  bool show_class = false;                       // color by h and v instead of by plane
  bool show_residual = false;                    // color by distance to the active plane
  std::string tab = "planes";                    // planes | review | checks | statistics | learning
  std::string compare_with;        // other side of the review: empty: the run, else a label folder
  double review_smallest_cm2 = 5;  // smaller regions are excluded from the review
  int review_item = -1;            // in the queue
  bool review_slivers = false;     // list slivers one by one
  int finding = -1;                // in the audit
};

}  // namespace planescope::desktop
