// What is labelled on the frame, who spent how long on it, and the latest gestures.

#include <fmt/format.h>

#include <numeric>

#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
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
  line("labeled area", area_text(s.labelled_m2));
  line("planes", fmt::format("{}: {} h, {} v", s.planes, s.h, s.v));
  const char* const sample = sample_name(*ui.state.label_frame());
  line("labeled", share_text(s.labelled, s.measured, sample));
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

}  // namespace planescope::desktop
