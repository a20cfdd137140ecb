#pragma once

// What label actions share: the frame and its labels, planes, gestures and what they leave behind.

#include <optional>
#include <span>
#include <string>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// The frame that is labelled, and its labels.
struct LabelWork {
  const LabelFrame& frame;
  std::shared_ptr<const FrameLabels> labels;
};
/// The label mode is on, and the frame is ready.
bool can_label(const State& state);
/// What labels are drawn on, for messages: "pixel", or in a cloud "point".
const char* sample_name(const LabelFrame& frame);
/// Throws Error where it is not.
LabelWork label_work(const State& state);
/// Of the frame's labels, for one gesture.
labels::LabelDraft draft_of(const State& state);

/// The number of a label's plane. Text: "3" or "P3".
Takes<int> plane_number(std::string shown, int low);
/// `chosen`, or the active one. Throws Error where there is no such plane.
int active_plane(const State& state, const std::optional<int>& chosen = {});

/// commit_labels(), and the title in the status bar; `unchanged` where nothing differs.
void commit_and_say(State& state,
                    const std::string& title,
                    labels::LabelDraft& draft,
                    const std::string& unchanged = "");

/// What is known of a frame's labels: what is at hand, or what the label folder had.
FrameMark frame_mark(const State& state, int frame);
/// Of the whole recording.
struct LabelProgress {
  int frames = 0, labelled = 0, reviewed = 0;
};
LabelProgress progress_of(const State& state);

/// The labels of any frame, opened where they were not yet: from the label files and the journal.
/// Null where the frame has none, or they cannot be read.
std::shared_ptr<const FrameLabels> labels_at(const OpenRecording& open, int frame);

/// Moves both views there, with room around. Nothing for no pixels.
void look_at_pixels(State& state, std::span<const std::uint32_t> pixels);

/// Shows the next frame, and asks for the labels of this one on it. `plan`: how far to go on.
/// Throws Error where nothing can be carried.
void begin_carry(State& state, const CarryJob& plan);

/// Asks for the labels of this frame in all that see its planes. Throws Error where planes were not
/// followed, or nothing can be proposed.
void begin_spread(State& state);
/// The same of the selected track, in all frames.
void begin_spread_of_track(State& state);

/// A run on the pixels of its frame: -1 where it was cropped or nothing was measured.
labels::OtherLabels labels_of_run(const debug::Run& run, const labels::LabelGrid& grid);

// ---- What tools leave on the pixels that they took ---------------------------------------------

/// "P3", "ignore", "nothing", "h", "v".
std::string name_of_paint(const labels::Paint& paint);
/// What strokes leave, as it was chosen. For plane 0, the id that a new plane gets.
labels::Paint paint_in_hand(const State& state);
/// One undo step, its plane the active one from then on. Throws Error where nothing may be changed;
/// where nothing would be, it says so.
void paint_pixels(State& state,
                  const std::string& tool,
                  std::span<const std::uint32_t> pixels,
                  const labels::Paint& paint,
                  labels::PaintMode mode);

// ---- Gestures ----------------------------------------------------------------------------------
// Gestures of the label mode, and the pixels that they mean. As text: "VIEW [MODE] [RADIUS] X,Y X,Y
// ...". VIEW is "image", whose pixels are the depth image's, or "space:WxH", a view of that size
// through the camera in force. MODE is over, add or subtract; over where it is left out. RADIUS is
// a brush's.

/// Whether the frame is ready to be labelled and its labels are loaded.
bool labels_at_hand(const State& state);

struct LabelGesture {
  DrawnIn where = DrawnIn::image;
  int width = 0, height = 0;  // of the view in space
  labels::PaintMode mode = labels::PaintMode::over;
  std::optional<float> radius_px;
  std::vector<labels::Vec2f> path;
};
/// With that many places or more.
Takes<LabelGesture> gesture(std::string shown, std::size_t least_places);
/// One place, in a view or, as "U,V", on the image.
Takes<LabelGesture> place_in_view(std::string shown);

/// Throws Error in a cloud, which has none to draw on.
void expect_image(const State& state);

/// The pixel that its first place means; -1 where nothing is seen there. Throws Error outside of
/// the image.
std::int64_t pixel_of_gesture(State& state, const std::string& action, const LabelGesture& where);
/// The wand's, within its limits; a plane that it shows grows anew.
void set_wand_tolerance(State& state, double wanted_m);

/// What a stroke (where a radius is given) or a closed path takes.
labels::SpaceSelection selected_by(State& state, const LabelGesture& gesture);

/// On which side of a line on the view each pixel's point lies, as split_by_side() takes it.
std::vector<float> sides_in_space(
    const State& state, int width, int height, const labels::Vec2f& from, const labels::Vec2f& to);

}  // namespace planescope::desktop
