// A classifier that learns from what was reviewed: its training, its gain, the frames in doubt.

#include "app/desktop/labeling/learning.hpp"

#include <fmt/format.h>

#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
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
            fmt::format("The classifier stored beside these labels was trained on {} in {} steps.",
                        counted(learnt.frames, "reviewed frame"), learnt.steps));
  if (learnt.since.frames == 0)
    paragraph(ui.colors.muted, "Frames that you review from now on will evaluate it.");
  draw_gain_on(ui, "reviewed since", learnt.since);
  draw_gain_on(ui, "kept aside", learnt.kept);
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
      ui.emit("frame.show", std::to_string(frame));
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
