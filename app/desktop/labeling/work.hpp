#pragma once

// Shared by label actions: the frame and its labels, planes, gestures and their effects.

#include <optional>
#include <span>
#include <string>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// The frame being labeled, and its labels.
struct LabelWork {
  const LabelFrame& frame;
  std::shared_ptr<const FrameLabels> labels;
};
/// Whether label mode is on and the frame is ready.
bool can_label(const State& state);
/// Name of the unit of labels in messages: "pixel", or in a cloud "point".
const char* sample_name(const LabelFrame& frame);
/// Throws Error if the frame is not ready.
LabelWork label_work(const State& state);
/// A draft of the frame's labels for one gesture.
labels::LabelDraft draft_of(const State& state);

/// A plane number of a label. Text: "3" or "P3".
Takes<int> plane_number(std::string shown, int low);
/// `chosen`, or the active plane. Throws Error if there is no such plane.
int active_plane(const State& state, const std::optional<int>& chosen = {});

/// Commits labels and shows the title in the status bar, or `unchanged` if nothing differs.
void commit_and_say(State& state,
                    const std::string& title,
                    labels::LabelDraft& draft,
                    const std::string& unchanged = "");

/// State of a frame's labels, from memory if it is open, otherwise from the label folder.
FrameMark frame_mark(const State& state, int frame);
/// Progress over the whole recording.
struct LabelProgress {
  int frames = 0, labeled = 0, reviewed = 0;
};
LabelProgress progress_of(const State& state);

/// The labels of any frame, loaded from the label files and the journal if necessary. Null if the
/// frame has none or they are unreadable.
std::shared_ptr<const FrameLabels> labels_at(const OpenRecording& open, int frame);

/// Moves both views to the pixels, with some surroundings. Does nothing without pixels.
void look_at_pixels(State& state, std::span<const std::uint32_t> pixels);

/// Shows the next frame and requests the labels of this one on it. `plan` says how far to continue.
/// Throws Error if nothing can be carried.
void begin_carry(State& state, const CarryJob& plan);

/// Requests the labels of this frame in all frames that see its planes. Throws Error if planes were
/// not tracked or nothing can be proposed.
void begin_spread(State& state);
/// The same for the selected track, in all frames.
void begin_spread_of_track(State& state);

/// A run on the pixels of its frame: -1 where cropped or not measured.
labels::OtherLabels labels_of_run(const debug::Run& run, const labels::LabelGrid& grid);

// ---- Effects of tools on pixels ----------------------------------------------------------------

/// "P3", "ignore", "nothing", "h", "v".
std::string name_of_paint(const labels::Paint& paint);
/// The chosen effect of strokes. Plane 0 becomes the id of a new plane.
labels::Paint paint_in_hand(const State& state);
/// Adds one undo step and makes its plane active. Throws Error if nothing may be changed; reports
/// if nothing would change.
void paint_pixels(State& state,
                  const std::string& tool,
                  std::span<const std::uint32_t> pixels,
                  const labels::Paint& paint,
                  labels::PaintMode mode);

// ---- Gestures ----------------------------------------------------------------------------------
// Gestures of label mode and the pixels that they select. As text: "VIEW [MODE] [RADIUS] X,Y X,Y
// ...". VIEW is "image", with positions in depth pixels, or "space:WxH", a view of that size from
// the current camera. MODE is over (default), add or subtract. RADIUS is for brushes.

/// Whether the frame is ready to be labeled and its labels are loaded.
bool labels_at_hand(const State& state);

struct LabelGesture {
  DrawnIn where = DrawnIn::image;
  int width = 0, height = 0;  // of the 3D view
  labels::PaintMode mode = labels::PaintMode::over;
  std::optional<float> radius_px;
  std::vector<labels::Vec2f> path;
};
/// With `least_places` positions or more.
Takes<LabelGesture> gesture(std::string shown, std::size_t least_places);
/// One position, in a view or, as "U,V", in the image.
Takes<LabelGesture> place_in_view(std::string shown);

/// Throws Error for a cloud, which has no image to draw on.
void expect_image(const State& state);

/// The pixel at its first position; -1 if nothing is visible there. Throws Error outside the image.
std::int64_t pixel_of_gesture(State& state, const std::string& action, const LabelGesture& where);
/// Sets the wand's tolerance within its limits and regrows a preview.
void set_wand_tolerance(State& state, double wanted_m);

/// The pixels selected by a stroke (if it has a radius) or a closed path.
labels::SpaceSelection selected_by(State& state, const LabelGesture& gesture);

/// The side of a line in the view on which each pixel's point is, as input for split_by_side().
std::vector<float> sides_in_space(
    const State& state, int width, int height, const labels::Vec2f& from, const labels::Vec2f& to);

}  // namespace planescope::desktop
