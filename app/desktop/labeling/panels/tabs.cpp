// The smaller tabs of label mode: checks, statistics, learning.

#include <fmt/format.h>

#include <numeric>

#include "app/desktop/labeling/learning.hpp"
#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {

// ---- Checks: suspicious labels by kind; click one to show it ------------------------------------

namespace {

const char* title_of(labels::FindingKind kind) {
  switch (kind) {
    case labels::FindingKind::camera:
      return "Drawn with other intrinsics";
    case labels::FindingKind::rms:
      return "Plane does not fit its pixels";
    case labels::FindingKind::outliers:
      return "Pixels far from the plane";
    case labels::FindingKind::parts:
      return "Separate pieces";
    case labels::FindingKind::tiny:
      return "Very small";
    case labels::FindingKind::class_normal:
      return "Class contradicts tilt";
    default:
      return "Not labeled";
  }
}

void draw_finding(const Ui& ui, std::size_t index, const labels::Finding& finding) {
  const std::string widget = fmt::format("checks.{}", index);
  const bool chosen = ui.state.view.label.finding == static_cast<int>(index);
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorPos();
  const float height = ImGui::CalcTextSize(finding.text.c_str(), nullptr, false, width).y;
  if (ImGui::Selectable(("##" + widget).c_str(), chosen, 0, ImVec2(width, height)))
    ui.act("check.show", index);
  ui.name(widget);
  const ImVec2 after = ImGui::GetCursorPos();
  ImGui::SetCursorPos(at);
  paragraph(ui.colors.text, finding.text);
  if (ImGui::GetCursorPosY() < after.y) ImGui::SetCursorPos(after);
}

}  // namespace

void draw_label_checks(const Ui& ui) {
  const std::shared_ptr<const FrameLabels> labels = labels_to_show(ui);
  if (!labels) return;
  const Audit* audit = ui.state.results.label.audit.get();
  if (!audit) return paragraph(ui.colors.muted, "Checking the labels …");
  if (audit->findings.empty()) {
    paragraph(ui.colors.good,
              labels->planes.empty() ? "There are no labels to check." : "No problems found.");
    return;
  }
  ImGui::AlignTextToFramePadding();
  paragraph(ui.colors.muted, counted(audit->findings.size(), "finding"));
  ImGui::SameLine();
  action_button(ui, "check.next", "next");
  ImGui::BeginChild("findings");
  for (std::size_t i = 0; i < audit->findings.size(); ++i) {
    const labels::Finding& finding = audit->findings[i];
    if (i == 0 || audit->findings[i - 1].kind != finding.kind) {
      ImGui::Spacing();
      heading(ui, title_of(finding.kind));
    }
    draw_finding(ui, i, finding);
  }
  ImGui::EndChild();
}

// ---- Statistics: labeled area, time per annotator, latest gestures ------------------------------

namespace {

constexpr std::size_t kHistory = 30;  // entries

void line(const std::string& name, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name.c_str());
  cell(value);
}

std::string share_text(std::size_t pixels, std::size_t of, const char* sample) {
  const double share = of == 0 ? 0 : static_cast<double>(pixels) / static_cast<double>(of);
  return fmt::format("{}, {:.1f} %", counted(pixels, sample), 100 * share);
}

void draw_frame(const Ui& ui, const FrameLabels& labels, const labels::LabelStatistics& s) {
  heading(ui, fmt::format("Frame {}", ui.state.document.frame));
  if (!ImGui::BeginTable("frame", 2, kTable)) return;
  line("labeled area", area_text(s.labeled_m2));
  line("planes", fmt::format("{}: {} h, {} v", s.planes, s.h, s.v));
  const char* const sample = sample_name(*ui.state.label_frame());
  line("labeled", share_text(s.labeled, s.measured, sample));
  line("ignored", share_text(s.ignored, s.measured, sample));
  if (s.hidden > 0) line("hidden", share_text(s.hidden, s.measured, sample));
  line("review", labels.review_state.empty() ? "unreviewed" : labels.review_state);
  ImGui::EndTable();
}

void draw_work(const Ui& ui, const std::vector<labels::WorkTime>& work) {
  heading(ui, "Time");
  if (work.empty()) return paragraph(ui.colors.muted, "Nothing is labeled yet.");
  if (!ImGui::BeginTable("work", 4, kTable)) return;
  for (const char* title : {"frame", "annotator", "time", "gestures"})
    ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  for (const labels::WorkTime& one : work) {
    line(std::to_string(one.frame), one.annotator);
    cell(minutes_text(one.seconds) + " min");
    cell(std::to_string(one.gestures));
  }
  ImGui::EndTable();
  const double total =
      std::accumulate(work.begin(), work.end(), 0.0,
                      [](double sum, const labels::WorkTime& w) { return sum + w.seconds; });
  paragraph(ui.colors.muted, "total " + minutes_text(total) + " min");
  ui.name("statistics.time");
}

void draw_history(const Ui& ui, const labels::LabelStore& store) {
  heading(ui, "Latest gestures");
  const std::vector<labels::HistoryEntry> entries = store.history(kHistory);
  if (entries.empty()) return paragraph(ui.colors.muted, "None yet.");
  if (!ImGui::BeginTable("history", 3, kTable)) return;
  ImGui::TableSetupColumn("gesture", ImGuiTableColumnFlags_WidthStretch);
  for (const char* title : {"frame", "pixels"}) fixed_column(title, "000000");
  ImGui::TableHeadersRow();
  for (const labels::HistoryEntry& entry : entries) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    paragraph(ui.colors.text, entry.title);
    tooltip("by " + entry.annotator);
    cell(std::to_string(entry.frame));
    cell(std::to_string(entry.pixels));
  }
  ImGui::EndTable();
  ui.name("statistics.history");
}

}  // namespace

void draw_label_statistics(const Ui& ui) {
  const std::shared_ptr<const FrameLabels> labels = labels_to_show(ui);
  if (!labels) return;
  const labels::LabelStore& store = *ui.state.document.current()->labels;
  draw_frame(ui, *labels, facts_of(ui, labels).statistics);
  ui.name("statistics.frame");
  ImGui::Spacing();
  draw_work(ui, ui.state.results.label.work);
  ImGui::Spacing();
  draw_history(ui, store);
}

// ---- Learning: a classifier trained on reviewed frames ------------------------------------------

namespace {

void draw_training(const Ui& ui, const Learning::Training& training) {
  heading(ui, "Training");
  const int reviewed = progress_of(ui.state).reviewed;
  if (training.running) {
    const double share = training.total > 0 ? double(training.done) / training.total : 0;
    share_bar(share, training.total > 0
                         ? fmt::format("{} {} of {}", training.stage, training.done, training.total)
                         : "begins …");
    ui.name("learning.progress");
    return action_button(ui, "label.learn.stop", "Stop");
  }
  paragraph(ui.colors.muted,
            reviewed == 0
                ? "No frame is reviewed yet. The classifier learns from frames that you mark "
                  "reviewed (Shift+D)."
                : fmt::format("{} to learn from.",
                              counted(static_cast<std::size_t>(reviewed), "reviewed frame")));
  action_button(ui, "label.learn", "Train the classifier");
}

void draw_gain_on(const Ui& ui, const char* frames, const Gain& gain) {
  if (gain.frames == 0) return;
  paragraph(ui.colors.text, fmt::format("On {} {}, points labeled correctly [%]:",
                                        counted(gain.frames, "frame"), frames));
  if (!ImGui::BeginTable(frames, 3, kTable)) return;
  for (const char* title : {"weights", "all", "near edges"}) ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  const auto row = [](const char* weights, const planes::LabelAccuracy& accuracy) {
    ImGui::TableNextRow();
    for (const std::string& text : {std::string(weights), fmt::format("{:.1f}", accuracy.percent()),
                                    fmt::format("{:.1f}", accuracy.edge_percent())})
      cell(text);
  };
  row("shipped", gain.before);
  row("trained", gain.after);
  ImGui::EndTable();
}

void draw_gain(const Ui& ui, const Learnt& learnt) {
  heading(ui, "Gain");
  paragraph(ui.colors.muted,
            fmt::format("The classifier stored with these labels was trained on {} in {} steps.",
                        counted(learnt.frames, "reviewed frame"), learnt.steps));
  if (learnt.since.frames == 0)
    paragraph(ui.colors.muted, "Frames that you review from now on will evaluate it.");
  draw_gain_on(ui, "reviewed since", learnt.since);
  draw_gain_on(ui, "held out", learnt.kept);
  ui.name("learning.gain");
}

void draw_doubt(const Ui& ui, const Learning::Doubt& doubt) {
  heading(ui, "Doubt");
  if (doubt.running) {
    const auto frames = static_cast<double>(std::max<std::size_t>(doubt.of_frame.size(), 1));
    share_bar(doubt.done / frames, fmt::format("{} of {:.0f} frames", doubt.done, frames));
  } else {
    action_button(ui, "label.next.doubtful",
                  doubt.of_frame.empty() ? "Find doubtful frames" : "Next");
  }
  if (doubt.of_frame.empty()) return;
  paragraph(ui.colors.muted, "Points below 75 % confidence, in frames that are not reviewed.");
  ImGui::BeginChild("doubt");
  for (const int frame : by_doubt(ui.state)) {
    const std::string text = fmt::format("frame {}: {:.1f} %", frame,
                                         100 * *doubt.of_frame[static_cast<std::size_t>(frame)]);
    if (ImGui::Selectable(text.c_str(), frame == ui.state.document.frame))
      ui.act("frame.show", frame);
    ui.name(fmt::format("learning.frame.{}", frame));
  }
  ImGui::EndChild();
}

}  // namespace

void draw_label_learning(const Ui& ui) {
  const Learning& learning = ui.state.results.label.learning;
  draw_training(ui, learning.training);
  ImGui::Spacing();
  if (!learning.refusal.empty()) paragraph(ui.colors.bad, learning.refusal);
  if (learning.learnt) draw_gain(ui, *learning.learnt);
  ImGui::Spacing();
  draw_doubt(ui, learning.doubt);
}

}  // namespace planescope::desktop
