#pragma once

// Every panel: one file each in panels/, debugger/panels/ or labeling/panels/. A panel draws into
// the ImGui window or tab that is open, and fills it.

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
void draw_keys(const Ui& ui);     // the key sheet

// In the debugger.
void draw_view3d(const Ui& ui);     // the scene at the cursor
void draw_image(const Ui& ui);      // colour or depth image at the cursor
void draw_timeline(const Ui& ui);   // scrubber
void draw_octree(const Ui& ui);     // tree of nodes
void draw_events(const Ui& ui);     // event list, filter, breakpoints
void draw_tracks(const Ui& ui);     // planes over all frames, and why one is missing
void draw_inspector(const Ui& ui);  // criteria of a node, terms of a merge, distances of a point
void draw_point(const Ui& ui);      // a point's life, why not
void draw_bookmarks(const Ui& ui);
void draw_planes(const Ui& ui);    // the result's planes, one a row
void draw_stairs(const Ui& ui);    // flights, kerbs, ramps, and why there is none
void draw_criteria(const Ui& ui);  // options as sliders
void draw_histograms(const Ui& ui);
void draw_compare(const Ui& ui);  // A/B
void draw_fix(const Ui& ui);      // what would fix this?

// In the label mode.
void draw_label_tools(const Ui& ui);       // the bar above both views
void draw_label_space(const Ui& ui);       // the points, and tools in space
void draw_label_image(const Ui& ui);       // the camera's image, and tools on it
void draw_label_planes(const Ui& ui);      // the planes, their class, the wand's numbers
void draw_label_review(const Ui& ui);      // the queue of disagreements
void draw_label_checks(const Ui& ui);      // what looks wrong
void draw_label_statistics(const Ui& ui);  // area, planes, time, history
void draw_label_learning(const Ui& ui);    // a classifier trained on what is reviewed

/// Of a finished plane, in the inspector: what it carries and how well it is known; nothing where
/// that is not known (debugger/panels/planes.cpp).
void draw_plane_facts(const Ui& ui, std::int32_t plane);

// Fixes (debugger/panels/fix.cpp).

/// A row each, with what it gains and moves elsewhere. `check`: with a button for what it does to
/// the labeled frames.
void draw_fix_table(const Ui& ui, const FixSearch& fix, bool check);
void draw_fix_progress(const Ui& ui, const FixSearch& fix);

/// What a click searches for the selected point. False: it asks for nothing, nothing is drawn.
bool draw_try(const Ui& ui);
/// Why the selected point is in no plane, or not in the one it should be: the decisions, and what
/// would change them. Draws nothing where neither is asked.
void draw_answer(const Ui& ui);

// What a recording needs first, and what was assumed about it (panels/setup.cpp).

/// The form for intrinsics, in place of the scene; false if it is not needed, nothing is drawn.
bool draw_camera_setup(const Ui& ui);
/// What the program had to assume about a recording, with the action that checks or settles it.
struct Assumption {
  std::string text;    // "53 % beyond 1.5 m"
  std::string button;  // "show 4 m"; empty: nothing settles it
  std::string why;     // for the tooltip: one sentence
  Command command;     // that checks or settles it
};

/// Assumptions about the current frame; empty before its first run and once dismissed.
std::vector<Assumption> assumptions_of(const State& state);
/// One line, above the views.
void draw_assumptions(const Ui& ui, const std::vector<Assumption>& all);

// Parts of several panels (panels/setup.cpp).

/// A line that says what to click where nobody knows gravity, or while a click is waited for;
/// otherwise nothing.
void draw_click_line(const Ui& ui);
/// Where gravity is from, and what picks another one.
void draw_gravity(const Ui& ui);

// What is measured (panels/views.cpp).

/// A line that says which end to click, and how far apart the two are.
void draw_measure_line(const Ui& ui);
/// The two ends and what is between them, over a view.
void draw_measured(const Ui& ui, const ScenePlacement& placed);
void draw_measured(const Ui& ui, const ImagePlacement& placed);

// Panels that share a place, as tabs: the window and the actions that choose one go by these
// tables.

struct Tab {
  const char* name;  // in actions and of widgets
  const char* title;
  void (*draw)(const Ui& ui);
};

/// Panels that the keyboard goes through, by the names of their windows. The menu comes first.
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
