// Histograms of the criteria's quantities: drag the threshold line to change it, drag over bars to
// create a filter. The selected node is marked.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

struct Plot {
  const debug::Histogram& histogram;
  ImVec2 min, max;
  float width() const { return max.x - min.x; }
  float x(double share) const { return min.x + static_cast<float>(share) * width(); }
  double share(float x) const { return std::clamp((x - min.x) / width(), 0.0f, 1.0f); }
};

std::uint32_t total(const debug::HistogramBin& bin) { return bin.right + bin.wrong + bin.unknown; }

void draw_bars(const Ui& ui, const Plot& plot) {
  const auto& bins = plot.histogram.bins;
  std::uint32_t most = 1;
  for (const debug::HistogramBin& bin : bins) most = std::max(most, total(bin));
  // Square roots, so that bars of ten are visible beside one of a thousand.
  const auto height = [&](std::uint32_t count) {
    return static_cast<float>(std::sqrt(static_cast<double>(count) / most)) *
           (plot.max.y - plot.min.y - ui.px(3));
  };
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 neutral = with_alpha(ui.colors.accent, 150);
  const ImU32 right = with_alpha(ui.colors.good, 150);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const float left = plot.x(static_cast<double>(i) / static_cast<double>(bins.size())) + 1;
    const float end = plot.x(static_cast<double>(i + 1) / static_cast<double>(bins.size()));
    std::uint32_t below = 0;
    const auto bar = [&](std::uint32_t count, ImU32 color) {
      if (count == 0) return;
      draw->AddRectFilled(ImVec2(left, plot.max.y - height(below + count)),
                          ImVec2(end, plot.max.y - height(below)), color);
      below += count;
    };
    bar(bins[i].wrong, ui.colors.bad);
    bar(bins[i].right, right);
    bar(bins[i].unknown, neutral);
  }
}

/// The value of the selected node, otherwise of the event at the cursor.
std::optional<double> value_here(const Ui& ui, const debug::Histogram& histogram) {
  const debug::Run& run = *ui.state.run();
  const std::int32_t node = ui.state.view.selected.node;
  const planes::TraceEvent* event = ui.state.event();
  const std::string& quantity = histogram.quantity;
  if (quantity == "offset")
    return event && event->type == planes::EventType::merge ? std::optional<double>(event->value)
                                                            : std::nullopt;
  if (quantity == "distance")
    return event && (event->type == planes::EventType::assign ||
                     event->type == planes::EventType::drop)
               ? std::optional<double>(event->value)
               : std::nullopt;
  if (node < 0 || node >= static_cast<std::int32_t>(run.facts.size())) return std::nullopt;
  const debug::NodeFacts& facts = run.facts[static_cast<std::size_t>(node)];
  if (quantity == "n_out") return facts.purity.n_out;
  if (quantity == "r_out") return facts.purity.r_out();
  if (quantity == "n_in") return facts.purity.n_in;
  if (quantity == "mse" || quantity == "rms") return facts.e_n;
  return std::nullopt;
}

void draw_marks(const Ui& ui, const Plot& plot) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const HistogramAxis axis(plot.histogram);
  if (std::isfinite(plot.histogram.threshold)) {
    const float x = plot.x(axis.share(plot.histogram.threshold));
    draw->AddLine(ImVec2(x, plot.min.y), ImVec2(x, plot.max.y), ui.colors.text, ui.px(1.5f));
    if (!plot.histogram.option.empty())  // a handle shows that the line can be dragged
      draw->AddCircleFilled(ImVec2(x, plot.min.y + ui.px(4)), ui.px(4), ui.colors.text);
  }
  if (const std::optional<double> value = value_here(ui, plot.histogram)) {
    const float x = plot.x(axis.share(*value));
    draw->AddTriangleFilled(ImVec2(x, plot.max.y - ui.px(9)), ImVec2(x - ui.px(5), plot.max.y),
                            ImVec2(x + ui.px(5), plot.max.y), ui.colors.warning);
  }
}

void draw_tooltip(const Plot& plot, double share) {
  const auto& bins = plot.histogram.bins;
  const debug::HistogramBin& bin = bins[std::min(
      bins.size() - 1, static_cast<std::size_t>(share * static_cast<double>(bins.size())))];
  std::string text = fmt::format("{} to {} {}: {}", number_text(bin.low), number_text(bin.high),
                                 plot.histogram.unit, total(bin));
  if (bin.right + bin.wrong > 0) text += fmt::format(", {} of them wrong", bin.wrong);
  tooltip_at_mouse(text);
}

/// Handles drags of the threshold and over the bars.
void handle_mouse(const Ui& ui, const Plot& plot, const std::string& widget) {
  const debug::Histogram& histogram = plot.histogram;
  const HistogramAxis axis(histogram);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double share = plot.share(mouse.x);
  const bool has_line = !histogram.option.empty() && std::isfinite(histogram.threshold);
  const bool at_line =
      has_line && std::abs(plot.x(axis.share(histogram.threshold)) - mouse.x) < ui.px(6);
  double& from = ui.memory.numbers[widget];         // start of the drag
  std::string& dragging = ui.memory.texts[widget];  // "line" or "bars"

  if (ImGui::IsItemActivated()) {
    dragging = at_line ? "line" : "bars";
    from = share;
    ui.memory.grabbed = at_line ? histogram : debug::Histogram();
  }
  if (ImGui::IsItemActive() && dragging == "line") {
    const planes::OptionInfo& info = planes::find_option(histogram.option);
    const double value = std::stod(fmt::format("{:.3g}", axis.value(share)));
    const std::string text = planescope::planes::number_text(info, value);
    if (text != info.get(ui.state.document.options))
      ui.act("option.drag", OptionValue{histogram.option, text});
  } else if (ImGui::IsItemActive()) {
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(plot.x(std::min(from, share)), plot.min.y),
                                              ImVec2(plot.x(std::max(from, share)), plot.max.y),
                                              with_alpha(ui.colors.accent, 60));
  }
  if (ImGui::IsItemDeactivated()) {
    if (dragging == "line") ui.act("option.drop");
    ui.memory.grabbed = {};
    const std::string filter = filter_between(histogram, from, share);
    if (dragging == "bars" && std::abs(share - from) > 0.01 && !filter.empty())
      ui.act("filter.set", filter);
  }
  if (!ImGui::IsItemHovered()) return;
  if (at_line) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (!ImGui::IsItemActive()) draw_tooltip(plot, share);
}

void draw_title(const Ui& ui, const debug::Histogram& histogram) {
  math_text(ui, ui.colors.text, histogram.title);
  if (!histogram.option.empty()) {
    ImGui::SameLine();
    ImGui::PushFont(ui.small);
    ImGui::TextDisabled("%s", histogram.option.c_str());
    ImGui::PopFont();
  }
  if (!std::isfinite(histogram.threshold)) return;
  const std::string text = fmt::format("{} {}", number_text(histogram.threshold), histogram.unit);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(text.c_str()).x);
  ImGui::TextUnformatted(text.c_str());
}

/// Keeps the old histogram while its threshold is dragged: the bins of the new run differ, and the
/// line would move away from the mouse.
debug::Histogram held(const Ui& ui, const debug::Histogram& now) {
  debug::Histogram shown = now;
  if (ui.memory.grabbed.title == now.title) shown.bins = ui.memory.grabbed.bins;
  return shown;
}

/// Draws ticks at round values below the bars, as many as fit.
void draw_ticks(const Ui& ui, const Plot& plot) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float size = height_of(*ui.small), gap = ui.px(8);
  float free = plot.min.x;  // right end of the last label
  for (const double value : axis_ticks(plot.histogram)) {
    const float x = plot.x(HistogramAxis(plot.histogram).share(value));
    const std::string text = number_text(value);
    const float width = ui.small->CalcTextSizeA(size, FLT_MAX, 0, text.c_str()).x;
    const float left = std::clamp(x - width / 2, plot.min.x, plot.max.x - width);
    draw->AddLine(ImVec2(x, plot.max.y), ImVec2(x, plot.max.y + ui.px(4)), ui.colors.muted);
    if (left < free) continue;
    draw->AddText(ui.small, size, ImVec2(left, plot.max.y + ui.px(4)), ui.colors.muted,
                  text.c_str());
    free = left + width + gap;
  }
  ImGui::Dummy(ImVec2(1, size + ui.px(4)));
}

void draw_histogram(const Ui& ui, const debug::Histogram& now, std::size_t index) {
  const debug::Histogram histogram = held(ui, now);
  if (histogram.bins.empty()) return;
  const std::string widget = fmt::format(
      "histograms.{}", histogram.quantity.empty() ? std::to_string(index) : histogram.quantity);
  draw_title(ui, histogram);
  const ImVec2 size(ImGui::GetContentRegionAvail().x, ui.px(64));
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const Plot plot{histogram, min, ImVec2(min.x + size.x, min.y + size.y)};
  ImGui::GetWindowDrawList()->AddRectFilled(plot.min, plot.max, ui.colors.panel);
  draw_bars(ui, plot);
  draw_marks(ui, plot);
  ImGui::InvisibleButton(widget.c_str(), size);
  ui.name(widget);
  handle_mouse(ui, plot, widget);

  draw_ticks(ui, plot);
}

void draw_legend(const Ui& ui, bool truth) {
  ImGui::PushFont(ui.small);
  if (truth) {
    colored(ui.colors.good, "right");
    ImGui::SameLine();
    colored(ui.colors.bad, "wrong");
    ImGui::SameLine();
    ImGui::TextDisabled("By ground truth");
    same_line_if_fits("▲ this node");
  }
  colored(ui.colors.warning, "▲");
  ImGui::SameLine(0, ui.px(3));
  ImGui::TextDisabled("this node");
  const bool changed = !ui.state.undo.empty(), filtered = ui.state.view.search.filter.has_value();
  const char* hint = changed ? "Drag over bars to filter events."
                     : filtered
                         ? "Drag a line to change its threshold."
                         : "Drag a line to change its threshold, or over bars to filter events.";
  if (!changed || !filtered) paragraph(ui.colors.muted, hint);
  ImGui::PopFont();
}

}  // namespace

void draw_histograms(const Ui& ui) {
  const RunView* view = ui.state.run_view();
  if (!view)
    return paragraph(ui.colors.muted,
                     "Open a frame to see how its nodes are distributed around each threshold.");
  if (!view->run->is_ours())
    return paragraph(ui.colors.muted, debug::describe_event(*view->run, 0) + ".");
  if (view->run->steps() == 0)
    return paragraph(ui.colors.muted,
                     "No node was evaluated: no point of this frame is in "
                     "range. Raise max_range_m under Criteria, Cloud and octree.");
  draw_legend(ui, view->run->subject->voxel_truth.known());
  for (std::size_t i = 0; i < view->histograms.size(); ++i)
    draw_histogram(ui, view->histograms[i], i);
}

}  // namespace planescope::desktop
