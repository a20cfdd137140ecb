// A/B comparison: where two runs diverge and its consequences.

#include "core/debug/explain/compare.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {

namespace {

void draw_compare_controls(const Ui& ui) {
  const State& state = ui.state;
  const bool pinned = state.results.pinned != nullptr;
  if (button(ui, pinned ? "Pin again" : "Pin this run as A", "compare.pin",
             state.results.current != nullptr))
    ui.act("run.pin");
  same_line_if_fits("Unpin");
  if (button(ui, "Unpin", "compare.unpin", pinned)) ui.act("run.unpin");
  same_line_if_fits("Showing A");
  if (button(ui, state.view.flash ? "Showing A" : "Showing B", "compare.flash", pinned))
    ui.act("run.flash");
  tooltip("Shows the other run in all views   Space");
  same_line_if_fits("Back to A's options");
  if (button(ui, "Back to A's options", "compare.restore", pinned)) ui.act("run.restore");

  const auto choice = [&](const char* title, const char* name, Against against, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    if (ImGui::RadioButton(title, state.view.against == against))
      ui.act("compare.against", against);
    ImGui::EndDisabled();
    ui.name(std::string("compare.against.") + name);
  };
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("against");
  ImGui::SameLine();
  choice("nothing", "nothing", Against::nothing, true);
  same_line_if_fits("AAA");
  choice("A", "pinned", Against::pinned, pinned);
  same_line_if_fits("ground truth AA");
  const debug::Run* run = state.run();
  choice("ground truth", "truth", Against::truth, run && run->subject->voxel_truth.known());
}

void draw_options(const Ui& ui, const debug::Run& a, const debug::Run& b) {
  bool any = false;
  planes::PipelineOptions of_b = b.options;
  of_b.foot = a.options.foot;  // not part of a run: use the same for both
  of_b.stairs = a.options.stairs;
  for (const planes::OptionInfo& info : planes::option_table()) {
    const std::string before = info.get(a.options), after = info.get(of_b);
    if (before == after) continue;
    any = true;
    ImGui::TextUnformatted(info.title.c_str());
    tooltip(fmt::format("{} ({})", info.meaning, info.name));
    ImGui::SameLine(ui.px(180));
    ImGui::TextDisabled("%s", before.c_str());
    ImGui::SameLine();
    ImGui::TextUnformatted(("→ " + after).c_str());
  }
  if (!any) ImGui::TextDisabled("A and B have the same options");
}

void score_row(const Ui& ui, const char* name, const RunView& view, const RunView* before) {
  ImGui::TableNextRow();
  cell(name);
  ImGui::TableNextColumn();
  ImGui::Text("%zu", view.run->segmentation.planes.size());
  if (!view.score) return;  // no ground truth, no more columns
  const debug::QuickScore& score = *view.score;
  const int gain = before && before->score ? score.detected - before->score->detected : 0;
  ImGui::TableNextColumn();
  colored(gain_color(ui, gain), fmt::format("{} of {}", score.detected, score.planes.size()));
  ImGui::TableNextColumn();
  ImGui::Text("%.3f", score.mean_iou);
  ImGui::TableNextColumn();
  ImGui::Text("%.1f %%", 100 * score.in_no_plane);
}

void draw_scores(const Ui& ui, const RunView* a, const RunView& b) {
  std::vector<const char*> titles{"planes"};
  if (b.score) titles.insert(titles.end(), {"found", "mean IoU", "no plane"});
  if (!ImGui::BeginTable("scores", static_cast<int>(titles.size()) + 1, kTable)) return;
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("run").x);
  for (const char* title : titles) ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  if (a) score_row(ui, "A", *a, nullptr);
  score_row(ui, a ? "B" : "run", b, a);
  ImGui::EndTable();
}

void draw_divergence(const Ui& ui, const debug::Comparison& comparison) {
  paragraph(ui.colors.text, comparison.divergence);
  if (comparison.diverging_step_a == planes::kNever &&
      comparison.diverging_step_b == planes::kNever)
    return;
  if (button(ui, "Go to the first difference", "compare.diverging")) ui.act("compare.diverging");
}

/// A plane of a run by its id in the result; click to select it.
void plane_cell(
    const Ui& ui, const debug::Run& run, int id, bool shown, const std::string& widget) {
  ImGui::TableNextColumn();
  if (id == 0) return ImGui::TextDisabled("–");
  const std::int32_t founded = run.segmentation.planes[static_cast<std::size_t>(id - 1)].founded;
  const std::string text = debug::plane_name(run, founded);
  if (!shown) return ImGui::TextUnformatted(text.c_str());
  if (link(ui, text, widget)) ui.act("select.plane", PlaneRef{founded});
}

void draw_planes(const Ui& ui,
                 const debug::Run* a,
                 const debug::Run& b,
                 const debug::Comparison& comparison) {
  int lost = 0, gained = 0;
  for (const debug::PlanePair& pair : comparison.planes) {
    lost += pair.b == 0;
    gained += pair.a == 0;
  }
  const std::string title =
      fmt::format("Planes: {} matched, {} {}, {} {}###planes",
                  comparison.planes.size() - static_cast<std::size_t>(lost + gained), lost,
                  a ? "lost" : "missed", gained, a ? "gained" : "without truth");
  if (!ImGui::CollapsingHeader(title.c_str(), ImGuiTreeNodeFlags_DefaultOpen)) return;
  if (!ImGui::BeginTable("planes", 3, kTable)) return;
  ImGui::TableSetupColumn(a ? "A" : "truth");
  ImGui::TableSetupColumn(a ? "B" : "found");
  ImGui::TableSetupColumn("IoU");
  ImGui::TableHeadersRow();
  const bool flash = ui.state.view.flash;
  for (std::size_t i = comparison.planes.size(); i-- > 0;) {  // largest changes first
    const debug::PlanePair& pair = comparison.planes[i];
    ImGui::TableNextRow();
    if (a) {
      plane_cell(ui, *a, pair.a, flash, fmt::format("compare.plane.{}.a", i));
    } else {
      cell(pair.a > 0 ? std::to_string(pair.a) : "–");
    }
    plane_cell(ui, b, pair.b, !flash, fmt::format("compare.plane.{}.b", i));
    ImGui::TableNextColumn();
    if (pair.a == 0 || pair.b == 0)
      paragraph(ui.colors.bad, pair.b == 0 ? (a ? "lost" : "missed") : (a ? "gained" : "no truth"));
    else
      paragraph(pair.iou < 0.8 ? ui.colors.warning : ui.colors.text,
                fmt::format("{:.3f}", pair.iou));
  }
  ImGui::EndTable();
}

void case_cell(const Ui& ui, planes::Case c) {
  ImGui::TableNextColumn();
  if (c == planes::Case::none)
    ImGui::TextDisabled("missing");
  else
    case_badge(ui, c);
}

void draw_nodes(const Ui& ui,
                const debug::Run& a,
                const debug::Run& b,
                const debug::Comparison& comparison) {
  const auto count = static_cast<int>(comparison.nodes.size());
  if (!ImGui::CollapsingHeader(fmt::format("Nodes decided differently: {}###nodes", count).c_str()))
    return;
  const float height = ui.px(24) * static_cast<float>(std::min(count, 12) + 1);
  if (!ImGui::BeginTable("nodes", 4, kTable | ImGuiTableFlags_ScrollY, ImVec2(0, height))) return;
  for (const char* title : {"node", "points", "A", "B"}) ImGui::TableSetupColumn(title);
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  ImGuiListClipper clipper;
  clipper.Begin(count);
  const bool flash = ui.state.view.flash;
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const debug::NodeChange& change = comparison.nodes[static_cast<std::size_t>(i)];
      const planes::OctreeNode& node = change.a >= 0
                                           ? a.octree().nodes[static_cast<std::size_t>(change.a)]
                                           : b.octree().nodes[static_cast<std::size_t>(change.b)];
      const std::int32_t shown = flash ? change.a : change.b;
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      if (shown < 0)
        ImGui::TextDisabled("depth %d", node.depth);
      else if (link(ui, fmt::format("{} (depth {})", shown, node.depth),
                    fmt::format("compare.node.{}", shown)))
        ui.act("select.node", shown);
      ImGui::TableNextColumn();
      ImGui::Text("%u", node.size());
      case_cell(ui, change.case_a);
      case_cell(ui, change.case_b);
    }
  ImGui::EndTable();
}

}  // namespace

void draw_compare(const Ui& ui) {
  const Results& results = ui.state.results;
  draw_compare_controls(ui);
  ImGui::Spacing();
  if (!results.current) return paragraph(ui.colors.muted, "Open a frame to pin its run as A.");
  if (ui.state.view.against == Against::nothing) {
    const bool labeled = results.current->run->subject->voxel_truth.known();
    std::string text = results.pinned ? "A run is pinned: choose it as A."
                                      : "Pin a run as A, then change an option: the new run is B.";
    if (labeled) text += " Or compare with ground truth.";
    paragraph(ui.colors.muted, text);
    ui.name("compare.hint");
    return;
  }
  if (!results.comparison) return ImGui::TextDisabled("comparing …");
  // The compared runs: the shown run may be newer, with fewer nodes and planes.
  const debug::Comparison& comparison = *results.comparison;
  const RunView* a = results.compared_a.get();
  const RunView& b = *results.compared_b;
  if (a) {
    heading(ui, "Options");
    draw_options(ui, *a->run, *b.run);
    ImGui::Spacing();
  }
  draw_scores(ui, a, b);
  ImGui::Spacing();
  if (a) draw_divergence(ui, comparison);
  if (comparison.compared_sources > 0)
    paragraph(ui.colors.text,
              fmt::format("{} of {} points ({:.1f} %) {}", comparison.changed_sources.size(),
                          comparison.compared_sources,
                          100.0 * static_cast<double>(comparison.changed_sources.size()) /
                              static_cast<double>(comparison.compared_sources),
                          a ? "change plane" : "are not in the matching plane"));
  draw_planes(ui, a ? a->run.get() : nullptr, *b.run, comparison);
  if (a && a->run->is_ours() && b.run->is_ours()) draw_nodes(ui, *a->run, *b.run, comparison);
}

// History of a point, and the decision that put it in no plane or in the wrong one.

namespace {

/// Recomputed when the point or run changes; null if there is no point.
const PointHistory* point_history(const Ui& ui) {
  const bool flashed = ui.state.view.flash && ui.state.results.pinned;
  const std::shared_ptr<const RunView>& view =
      flashed ? ui.state.results.pinned : ui.state.results.current;
  PointHistory& point = ui.memory.point;
  const std::shared_ptr<const io::Recording>& recording = ui.state.document.current()->recording;
  const bool other_frame =
      point.of && (point.recording != recording ||
                   point.of->run->subject->frame.index != view->run->subject->frame.index);
  if (other_frame) point = {};
  // Keep the last point without a selection, because a click on a line of its history selects a
  // node.
  const auto selected = source_of(ui.state.view.selected, *view->run->subject);
  const std::int64_t source = selected ? static_cast<std::int64_t>(*selected) : point.source;
  if (source < 0) return nullptr;
  if (point.of != view || point.source != source) {
    const auto index = static_cast<std::size_t>(source);
    point = {recording, view, source, debug::history_of(*view->run, index),
             debug::why_not(*view->run, index)};
  }
  return &point;
}

void draw_why(const Ui& ui, const PointHistory& point) {
  const bool lost = point.why.answer.starts_with("Lost");
  heading(ui, lost ? "Why not?" : "Plane");
  math_paragraph(ui, lost ? ui.colors.warning : ui.colors.text, point.why.answer);
  if (point.why.step > 0) {
    if (button(ui, fmt::format("Step {}", point.why.step), "point.why"))
      ui.act("step.goto", point.why.step);
    ImGui::SameLine();
    if (button(ui, "Break on this point", "point.break")) {
      ui.act("select.voxel",
             point.of->run->subject->voxel_of_source(static_cast<std::size_t>(point.source)));
      ui.act("break.point");
    }
  }
  if (draw_try(ui)) return;
  const debug::Remedy& remedy = point.why.remedy;
  if (remedy.text.empty()) return;
  paragraph(ui.colors.muted, remedy.text);
  if (button(ui, fmt::format("Set {} = {}", remedy.option, remedy.value), "point.remedy"))
    ui.act("option.set", OptionValue{remedy.option, remedy.value});
}

/// Whether the step is beside its stage; in a narrow panel it is below.
bool steps_beside(const Ui& ui) { return ImGui::GetWindowWidth() > ui.px(340); }

float stage_width(const Ui& ui, const debug::HistoryEvent& event) {
  const float stage = ImGui::CalcTextSize(event.stage.c_str()).x;
  if (event.step <= 0) return stage;
  const float step = ImGui::CalcTextSize(std::to_string(event.step).c_str()).x;
  return steps_beside(ui) ? stage + ui.px(7) + step : std::max(stage, step);
}

/// One line of the history; click to go to its step.
void draw_station(const Ui& ui, const debug::HistoryEvent& event, std::size_t index) {
  const std::int32_t now = ui.state.view.step;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushFont(ui.small);
  colored(event.decisive ? ui.colors.warning : ui.colors.muted, event.stage);
  if (event.step > 0) {
    if (steps_beside(ui)) ImGui::SameLine(0, ui.px(7));
    colored(event.step == now ? ui.colors.accent : ui.colors.muted, std::to_string(event.step));
  }
  ImGui::PopFont();
  ImGui::TableNextColumn();
  if (event.decisive)
    ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg0, with_alpha(ui.colors.warning, 28));
  const std::string widget = fmt::format("point.life.{}", index);
  const bool later = event.step > now;
  if (event.step < 0) {
    math_paragraph(ui, ui.colors.text, event.text);
    ui.name(widget);
    return;
  }
  const ImVec2 min = ImGui::GetCursorScreenPos();
  math_paragraph(ui, later ? ui.colors.muted : ui.colors.text, event.text);
  ui.name(widget);
  const ImVec2 max(min.x + ImGui::GetContentRegionAvail().x, ImGui::GetItemRectMax().y);
  if (!ImGui::IsMouseHoveringRect(min, max) || !ImGui::IsWindowHovered()) return;
  ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  ImGui::GetWindowDrawList()->AddRect(min, max, ui.colors.accent, ui.px(2));
  if (ImGui::IsMouseClicked(0)) ui.act("step.goto", event.step);
}

}  // namespace

void draw_point(const Ui& ui) {
  const PointHistory* point = ui.state.run() ? point_history(ui) : nullptr;
  if (!point) {
    paragraph(ui.colors.muted,
              "Click a point in the image or in the scene to see its pixel, voxel, label, nodes "
              "and every decision about it.");
    return;
  }
  draw_why(ui, *point);
  ImGui::Spacing();
  ImGui::Separator();
  heading(ui, "History");
  if (!ImGui::BeginTable("life", 2, ImGuiTableFlags_PadOuterX)) return;
  ImGui::PushFont(ui.small);
  float widest = 0;
  for (const debug::HistoryEvent& event : point->life)
    widest = std::max(widest, stage_width(ui, event));
  ImGui::PopFont();
  ImGui::TableSetupColumn("stage", ImGuiTableColumnFlags_WidthFixed, widest + ui.px(4));
  ImGui::TableSetupColumn("text", ImGuiTableColumnFlags_WidthStretch);
  for (std::size_t i = 0; i < point->life.size(); ++i) draw_station(ui, point->life[i], i);
  ImGui::EndTable();
}

namespace {

/// The location of a bookmark, unless its name already shows it.
std::string place_of(const Bookmark& bookmark) {
  std::string place = fmt::format("frame {} step {}", bookmark.frame, bookmark.step);
  if (place == bookmark.name) place.clear();
  if (!bookmark.filter.empty())
    place += (place.empty() ? "filter " : ", filter ") + bookmark.filter;
  return place;
}

}  // namespace

void draw_bookmarks(const Ui& ui) {
  const auto& bookmarks = ui.state.document.bookmarks;
  if (ImGui::Button("Bookmark this view")) ui.act("bookmark.add");
  ui.name("bookmarks.add");
  same_line_if_fits("Save session …");
  if (ImGui::Button("Save session …")) ui.act("session.save");
  ui.name("bookmarks.save");
  if (bookmarks.empty()) {
    ImGui::Spacing();
    return paragraph(ui.colors.muted,
                     "A bookmark stores the frame, step, selection, filter, and "
                     "camera, with a note. Save the session to open it elsewhere.");
  }
  for (std::size_t i = 0; i < bookmarks.size(); ++i) {
    const Bookmark& bookmark = bookmarks[i];
    ImGui::PushID(static_cast<int>(i));
    ImGui::Separator();
    if (ImGui::Selectable(bookmark.name.c_str(), false, 0,
                          ImVec2(ImGui::GetContentRegionAvail().x - ui.px(70), 0)))
      ui.act("bookmark.go", i);
    ui.name(fmt::format("bookmarks.{}", i));
    ImGui::SameLine();
    if (ImGui::SmallButton("remove")) ui.act("bookmark.remove", i);
    ui.name(fmt::format("bookmarks.{}.remove", i));
    const std::string place = place_of(bookmark);
    if (!place.empty()) paragraph(ui.colors.muted, place);
    // Typed text stays in the panel until it is complete.
    const std::string key = fmt::format("bookmark.note.{}", i);
    std::string& text = ui.memory.texts[key];
    const bool editing = ui.memory.numbers[key] != 0;
    if (!editing) text = bookmark.note;
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##note", "a note", &text);
    ui.name(fmt::format("bookmarks.{}.note", i));
    ui.memory.numbers[key] = ImGui::IsItemActive() ? 1 : 0;
    if (ImGui::IsItemDeactivatedAfterEdit())
      ui.act("bookmark.note", BookmarkNote{static_cast<int>(i), text});
    ImGui::PopID();
  }
}

}  // namespace planescope::desktop
