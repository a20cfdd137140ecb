// Review panel: regions where labels disagree with the algorithm or another annotator.

#include "app/desktop/labeling/review.hpp"

#include <fmt/format.h>

#include <cmath>
#include <tuple>
#include <utility>

#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

const char* meaning_of(DisagreementKind kind) {
  switch (kind) {
    case DisagreementKind::missed:
      return "A labeled plane that the other side does not have";
    case DisagreementKind::invented:
      return "A plane on the other side that is not labeled";
    case DisagreementKind::split:
      return "A piece that the other side separates from a labeled plane";
    case DisagreementKind::merged:
      return "A plane on the other side that continues over another labeled plane";
    case DisagreementKind::class_flip:
      return "The same plane, horizontal on one side and vertical on the other";
    default:
      return "A thin strip along an edge";
  }
}

void draw_sides(const Ui& ui) {
  const std::string& folder = ui.state.view.label.compare_with;
  paragraph(ui.colors.muted, folder.empty() ? "Labels compared with the algorithm's result"
                                            : "Labels compared with those in " + folder);
  std::string& text = ui.memory.texts["review.folder"];
  ImGui::SetNextItemWidth(folder.empty() ? -1 : -ui.px(84));
  if (ImGui::InputTextWithHint("##folder", "label folder of another annotator", &text,
                               ImGuiInputTextFlags_EnterReturnsTrue))
    ui.act("review.against", text);
  ui.name("review.folder");
  auto cm2 = static_cast<float>(ui.state.view.label.review_smallest_cm2);
  const auto draw_smallest = [&] {
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("from");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ui.px(90));
    if (ImGui::SliderFloat("##smallest", &cm2, 0, 200, "%.0f cm²", ImGuiSliderFlags_AlwaysClamp))
      ui.act("review.smallest", std::round(cm2));
    ui.name("review.smallest");
    tooltip("Smaller regions are not listed");
  };
  if (folder.empty()) return draw_smallest();
  ImGui::SameLine();
  if (button(ui, "algorithm", "review.algorithm")) {
    text.clear();
    ui.act("review.against");
  }
  draw_smallest();
}

void draw_agreement(const Ui& ui, const labels::Agreement& agreement) {
  paragraph(ui.colors.text, fmt::format("mean IoU {:.3f}  ·  adjusted Rand index {:.3f}",
                                        agreement.mean_iou, agreement.adjusted_rand));
  ui.name("review.agreement");
  paragraph(ui.colors.muted,
            fmt::format("{} of {} and {} planes match  ·  same plane for {:.1f} % of the {}s, "
                        "same class for {:.1f} %",
                        agreement.matched, agreement.planes_a, agreement.planes_b,
                        100 * agreement.pixel_agreement, sample_name(*ui.state.label_frame()),
                        100 * agreement.label_accuracy));
}

std::string planes_text(int ours, int theirs) {
  const std::string a = ours > 0 ? fmt::format("P{}", ours) : "–";
  return theirs > 0 ? fmt::format("{} / {}", a, theirs) : fmt::format("{} / –", a);
}

/// Draws the first cell of a row that is selectable as a whole.
bool row(const Ui& ui, const std::string& widget, const std::string& text, bool chosen) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  const bool clicked = ImGui::Selectable((text + "##" + widget).c_str(), chosen,
                                         ImGuiSelectableFlags_SpanAllColumns);
  ui.name(widget);
  return clicked;
}

/// Draws one row for all slivers; click to list them. Its buttons are below the table.
void draw_sliver_row(const Ui& ui, const Slivers& slivers, bool listed) {
  const std::string text =
      fmt::format("{} {}, {} {}", listed ? "-" : "+",
                  counted(static_cast<std::size_t>(slivers.count), "sliver"), slivers.pixels,
                  ui.state.label_frame()->grid.is_cloud() ? "points" : "px");
  if (row(ui, "review.slivers", text, false)) ui.act("review.slivers", SliverAction::show);
  tooltip("Thin strips along edges; click to list them");
  for (int i = 0; i < 3; ++i) cell("");
}

void draw_open_items(const Ui& ui, const ReviewQueue& queue) {
  const int chosen = ui.state.view.label.review_item;
  double& scrolled_to = ui.memory.numbers["review.scrolled_to"];
  const Slivers slivers = slivers_of(queue);
  const bool grouped = slivers.count > 1;
  const bool inside = chosen >= 0 && chosen < static_cast<int>(queue.items.size()) &&
                      is_sliver(queue.items[static_cast<std::size_t>(chosen)]);
  const bool listed = !grouped || inside || ui.state.view.label.review_slivers;
  bool group_drawn = !grouped;
  for (std::size_t i = 0; i < queue.items.size(); ++i) {
    const labels::Disagreement& item = queue.items[i];
    if (item.note) continue;
    if (is_sliver(item)) {
      if (!std::exchange(group_drawn, true)) draw_sliver_row(ui, slivers, listed);
      if (!listed) break;  // slivers come last
    }
    const int index = static_cast<int>(i);
    if (row(ui, fmt::format("review.{}", i), to_string(item.kind), index == chosen))
      ui.act("review.item", i);
    tooltip(meaning_of(item.kind));
    if (index == chosen && scrolled_to != index) {
      ImGui::SetScrollHereY();
      scrolled_to = index;
    }
    cell(planes_text(item.label_plane, item.other_plane));
    cell(fmt::format("{:.0f} cm²", 1e4 * item.area_m2));
    cell("");
  }
}

void draw_decided_items(const Ui& ui, const std::vector<Decided>& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    const ReviewNote& note = all[i].note;
    const bool chosen = all[i].item >= 0 && all[i].item == ui.state.view.label.review_item;
    ImGui::PushStyleColor(ImGuiCol_Text, ui.colors.muted);
    if (row(ui, fmt::format("review.decided.{}", i), to_string(note.kind), chosen) &&
        all[i].item >= 0)
      ui.act("review.item", all[i].item);
    tooltip(fmt::format("{} by {}{}", past_tense(note.decision), note.reviewer,
                        all[i].item < 0 ? "; no longer different" : ""));
    cell(planes_text(note.label_plane, note.other_plane));
    cell(fmt::format("{} px", note.pixels));
    cell(past_tense(note.decision));
    ImGui::PopStyleColor();
  }
}

void draw_items(const Ui& ui,
                const ReviewQueue& queue,
                const std::vector<Decided>& done,
                float height) {
  if (!ImGui::BeginTable("queue", 4, kTable | ImGuiTableFlags_ScrollY, ImVec2(0, height))) return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
  fixed_column("planes", "P00 / 00");
  fixed_column("size", "0000 cm²");
  fixed_column("decided", "to edit");
  ImGui::TableHeadersRow();
  draw_open_items(ui, queue);
  draw_decided_items(ui, done);
  ImGui::EndTable();
}

void draw_decisions(const Ui& ui, const ReviewQueue& queue, const FrameLabels& labels) {
  const bool chosen = ui.state.view.label.review_item >= 0;
  ImGui::BeginDisabled(!chosen);
  if (button(ui, "Keep (Enter)", "review.keep")) ui.act("review.keep");
  tooltip("Keep the labels   Enter");
  constexpr const char* kButtons[][2] = {
      {"review.take", "Take (A)"}, {"review.edit", "Edit (E)"}, {"review.ignore", "Ignore (G)"}};
  for (const auto& [action, label] : kButtons) {
    same_line_if_fits(label);
    action_button(ui, action, label);
  }
  ImGui::EndDisabled();
  if (slivers_of(queue).count > 1) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("All slivers");
    constexpr std::tuple<SliverAction, const char*, const char*> kOfAll[] = {
        {SliverAction::keep, "keep", "Keep all"},
        {SliverAction::take, "take", "Take all"},
        {SliverAction::ignore, "ignore", "Ignore all"}};
    for (const auto& [what, name, label] : kOfAll) {
      same_line_if_fits(label);
      if (button(ui, label, fmt::format("review.slivers.{}", name))) ui.act("review.slivers", what);
    }
  }
  if (queue.undecided() > 0) return;
  const bool reviewed = labels.review_state == "reviewed";
  paragraph(reviewed ? ui.colors.good : ui.colors.text,
            reviewed ? "This frame is reviewed." : "All regions are decided.");
  action_button(ui, "review.done", reviewed ? "Not reviewed" : "Mark as reviewed");
}

}  // namespace

void draw_label_review(const Ui& ui) {
  const std::shared_ptr<const FrameLabels> labels = labels_to_show(ui);
  if (!labels) return;
  draw_sides(ui);
  const LabelResults& results = ui.state.results.label;
  if (!results.review_refusal.empty()) return paragraph(ui.colors.bad, results.review_refusal);
  const ReviewQueue* queue = results.review.get();
  if (!queue) return paragraph(ui.colors.muted, "Comparing …");
  if (queue->agreement) draw_agreement(ui, *queue->agreement);
  const std::vector<Decided> done = decided_items(*labels, *queue);
  const std::size_t all = queue->undecided() + done.size();
  if (all == 0) {
    paragraph(ui.colors.good, "No differences.");
  } else {
    share_bar(static_cast<double>(done.size()) / static_cast<double>(all),
              fmt::format("{} of {} decided", done.size(), all));
    ui.name("review.progress");
  }
  list_above(
      ui, "review.below", [&](float height) { draw_items(ui, *queue, done, height); },
      [&] { draw_decisions(ui, *queue, *labels); });
}

}  // namespace planescope::desktop
