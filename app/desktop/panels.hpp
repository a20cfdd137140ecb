#pragma once

// All panels, one file each in panels/, debugger/panels/, labeling/panels/ or tracks/panels/. A
// panel draws into and fills the current ImGui window or tab.

#include <cstdint>
#include <string_view>
#include <vector>

#include "app/desktop/actions/actions.hpp"

namespace planescope::desktop {

struct FixSearch;
struct ImagePlacement;
struct ScenePlacement;
struct Ui;

// In every mode.
void draw_menu(const Ui& ui);     // the menu bar
void draw_status(const Ui& ui);   // the status bar
void draw_frames(const Ui& ui);   // recordings, frame strip
void draw_palette(const Ui& ui);  // find an action by name
void draw_keys(const Ui& ui);     // keyboard shortcuts

// In the debugger.
void draw_view3d(const Ui& ui);     // the scene at the cursor
void draw_image(const Ui& ui);      // color or depth image at the cursor
void draw_timeline(const Ui& ui);   // scrubber
void draw_octree(const Ui& ui);     // tree of nodes
void draw_events(const Ui& ui);     // event list, filter, breakpoints
void draw_tracks(const Ui& ui);     // tracks of planes over all frames, and reasons for gaps
void draw_inspector(const Ui& ui);  // criteria of a node, terms of a merge, distances of a point
void draw_point(const Ui& ui);      // history of a point and "why not" answers
void draw_bookmarks(const Ui& ui);
void draw_planes(const Ui& ui);    // planes of the result, one per row
void draw_stairs(const Ui& ui);    // flights, kerbs and ramps, or why there are none
void draw_criteria(const Ui& ui);  // options as sliders
void draw_histograms(const Ui& ui);
void draw_compare(const Ui& ui);  // A/B
void draw_fix(const Ui& ui);      // search for option changes that fix a result

// In the label mode.
void draw_label_tools(const Ui& ui);       // toolbar above both views
void draw_label_space(const Ui& ui);       // 3D points and tools
void draw_label_image(const Ui& ui);       // camera image and tools
void draw_label_planes(const Ui& ui);      // planes, their classes, and wand options
void draw_label_review(const Ui& ui);      // queue of disagreements
void draw_label_checks(const Ui& ui);      // suspicious labels
void draw_label_statistics(const Ui& ui);  // area, planes, time, history
void draw_label_learning(const Ui& ui);    // classifier trained on reviewed frames

/// Inspector section about a finished plane: foothold verdict, figures, and reasons for missing
/// steps; empty if unknown (debugger/panels/planes.cpp).
void draw_plane_facts(const Ui& ui, std::int32_t plane);

// Fixes (debugger/panels/fix.cpp).

/// One row per fix with its gains and side effects. With `check`, each row has a button that tests
/// it on the labeled frames.
void draw_fix_table(const Ui& ui, const FixSearch& fix, bool check);
void draw_fix_progress(const Ui& ui, const FixSearch& fix);

/// Search results for a click on the selected point. Returns false and draws nothing if there is no
/// search.
bool draw_try(const Ui& ui);
/// Explains why the selected point is in no plane or in the wrong one: the decisions, and changes
/// that would fix them. Draws nothing otherwise.
void draw_answer(const Ui& ui);

// Required settings and assumptions of a recording (panels/setup.cpp).

/// Draws the intrinsics form instead of the scene. Returns false and draws nothing if it is not
/// needed.
bool draw_camera_setup(const Ui& ui);
/// An assumption about a recording, with the action that checks or settles it.
struct Assumption {
  std::string text;    // "53 % beyond 1.5 m"
  std::string button;  // "show 4 m"; empty: no button
  std::string why;     // tooltip, one sentence
  Command command;     // checks or settles it
};

/// Assumptions about the current frame; empty before its first run and after being dismissed.
std::vector<Assumption> assumptions_of(const State& state);
/// Draws one line above the views.
void draw_assumptions(const Ui& ui, const std::vector<Assumption>& all);

// Shared by several panels (panels/setup.cpp).

/// A line that says what to click if gravity is unknown or a click is pending; otherwise nothing.
void draw_click_line(const Ui& ui);
/// The source of gravity, and buttons to pick another one.
void draw_gravity(const Ui& ui);

// Measurements (panels/views.cpp).

/// A line that asks for the next end to click and shows the distance between both.
void draw_measure_line(const Ui& ui);
/// Draws both ends and the line between them over a view.
void draw_measured(const Ui& ui, const ScenePlacement& placed);
void draw_measured(const Ui& ui, const ImagePlacement& placed);

// Tabs in shared areas. The window and the actions that select a tab use these tables.

struct Tab {
  const char* name;  // in action and widget names
  const char* title;
  void (*draw)(const Ui& ui);
};

/// Panels in keyboard order, by window name. The menu comes first.
inline constexpr std::string_view kMenuPanel = "menu";
inline constexpr std::string_view kDebuggerPanels[] = {
    kMenuPanel, "frames", "view3d", "image", "timeline", "octree", "events", "inspector", "tools"};

inline constexpr Tab kInspectorTabs[] = {{"inspector", "Inspector", draw_inspector},
                                         {"planes", "Planes", draw_planes},
                                         {"point", "Point", draw_point},
                                         {"stairs", "Stairs", draw_stairs},
                                         {"bookmarks", "Bookmarks", draw_bookmarks}};
inline constexpr Tab kListTabs[] = {{"events", "Events", draw_events},
                                    {"tracks", "Tracks", draw_tracks}};
inline constexpr Tab kToolTabs[] = {{"criteria", "Criteria", draw_criteria},
                                    {"histograms", "Histograms", draw_histograms},
                                    {"compare", "A/B", draw_compare},
                                    {"fix", "Fix", draw_fix}};
inline constexpr Tab kLabelTabs[] = {{"planes", "Planes", draw_label_planes},
                                     {"review", "Review", draw_label_review},
                                     {"checks", "Checks", draw_label_checks},
                                     {"statistics", "Statistics", draw_label_statistics},
                                     {"learning", "Learning", draw_label_learning}};

}  // namespace planescope::desktop
