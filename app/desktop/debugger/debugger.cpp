// Data behind the debugger panels: event groups, octree rows, slider scales and filter completion.

#include "app/desktop/debugger/debugger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/desktop/imgui.hpp"
#include "app/desktop/ui.hpp"
#include "core/debug/replay/steps.hpp"
#include "core/model/text.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::desktop {

// ---- Events -------------------------------------------------------------------------------------

namespace {

constexpr std::int32_t kLeastGroup = 3;  // two lines are as readable as one group

bool is_leftover(const planes::TraceEvent& event) {
  return event.point >= 0 &&
         (event.type == planes::EventType::assign || event.type == planes::EventType::drop);
}

/// Whether `b` continues the group of `a`.
bool same_kind(const planes::TraceEvent& a, const planes::TraceEvent& b) {
  if (a.stage != b.stage || a.point < 0 || b.point < 0) return false;
  if (is_leftover(a)) return is_leftover(b);
  if (a.type != planes::EventType::refine || b.type != a.type) return false;
  // Pixel stages go by position instead of plane by plane.
  return planes::info_of(a.stage)->on_pixels || (a.plane == b.plane && a.other == b.other);
}

}  // namespace

std::vector<EventRow> event_groups(const debug::Run& run) {
  std::vector<EventRow> rows;
  for (const debug::Phase& phase : debug::phases_of(run)) {
    rows.push_back({EventRow::Kind::stage, phase.steps.first, phase.steps.last, phase.title});
    for (std::int32_t step = phase.steps.first, end = step; step <= phase.steps.last; step = end) {
      const planes::TraceEvent& event = *run.event_at(step);
      end = step + 1;
      while (end <= phase.steps.last && same_kind(event, *run.event_at(end))) ++end;
      if (end - step < kLeastGroup) end = step + 1;
      rows.push_back(
          {end > step + 1 ? EventRow::Kind::group : EventRow::Kind::event, step, end - 1});
    }
  }
  return rows;
}

std::vector<EventRow> opened(const std::vector<EventRow>& groups,
                             const std::set<std::int32_t>& open,
                             std::int32_t step) {
  std::vector<EventRow> rows;
  for (const EventRow& row : groups) {
    rows.push_back(row);
    if (row.kind != EventRow::Kind::group) continue;
    // At its end the whole group has happened and is shown as one line.
    const bool inside = step >= row.first && step < row.last;
    if (!inside && !open.contains(row.first)) continue;
    for (std::int32_t at = row.first; at <= row.last; ++at)
      rows.push_back({EventRow::Kind::event, at, at});
  }
  return rows;
}

std::string group_text(const debug::Run& run, const EventRow& group) {
  const planes::TraceEvent& first = *run.event_at(group.first);
  const auto count = static_cast<std::size_t>(group.last - group.first + 1);
  std::set<std::int32_t> planes;
  if (!is_leftover(first)) {
    bool all_alike = true;
    for (std::int32_t step = group.first; step <= group.last; ++step) {
      const planes::TraceEvent& event = *run.event_at(step);
      planes.insert({event.plane, event.other});
      all_alike = all_alike && event.plane == first.plane && event.other == first.other;
    }
    const std::string what =
        fmt::format("{} moves {} ", planes::to_string(first.stage), counted(count, "point"));
    if (!all_alike) return what + "between " + counted(planes.size(), "plane");
    return what + fmt::format("from {} to {}", debug::plane_name(run, first.plane),
                              debug::plane_name(run, first.other));
  }
  std::size_t given = 0;
  for (std::int32_t step = group.first; step <= group.last; ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.type != planes::EventType::assign) continue;
    ++given;
    planes.insert(event.plane);
  }
  const std::size_t left = count - given;
  if (given == 0) return counted(left, "point") + (left == 1 ? " stays" : " stay") + " unassigned";
  std::string text = fmt::format("{} {} to {}", counted(given, "point"), given == 1 ? "goes" : "go",
                                 planes.size() == 1 ? debug::plane_name(run, *planes.begin())
                                                    : counted(planes.size(), "plane"));
  if (left > 0) text += fmt::format(", {} {} unassigned", left, left == 1 ? "stays" : "stay");
  return text;
}

// ---- Octree -------------------------------------------------------------------------------------

namespace {

/// Per node, the step from which it and all nodes below it are settled.
std::vector<std::int32_t> settled_below(const debug::Run& run) {
  const auto decided = run.timeline.decided_at();
  std::vector<std::int32_t> settled(decided.begin(), decided.end());
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  for (std::size_t n = nodes.size(); n-- > 1;) {  // children come after their parents
    std::int32_t& parent = settled[static_cast<std::size_t>(nodes[n].parent)];
    parent = std::max(parent, settled[n]);
  }
  return settled;
}

std::vector<std::uint8_t> path_to(const debug::Run& run, std::int32_t node) {
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  std::vector<std::uint8_t> on_path(nodes.size(), 0);
  while (node > 0) {
    node = nodes[static_cast<std::size_t>(node)].parent;
    on_path[static_cast<std::size_t>(node)] = 1;
  }
  return on_path;
}

bool is_born(const debug::Run& run, std::int32_t node, std::int32_t step) {
  return run.timeline.node_state(node, step) != debug::NodeState::unborn;
}

bool has_born_children(const debug::Run& run, std::int32_t node, std::int32_t step) {
  const std::int32_t child = run.octree().nodes[static_cast<std::size_t>(node)].first_child;
  return child >= 0 && is_born(run, child, step);
}

}  // namespace

std::vector<OctreeRow> octree_rows(const debug::Run& run,
                                   std::int32_t step,
                                   std::int32_t selected,
                                   const std::map<std::int32_t, bool>& folds) {
  std::vector<OctreeRow> rows;
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  if (nodes.empty()) return rows;
  const std::vector<std::int32_t> settled = settled_below(run);
  const std::vector<std::uint8_t> on_path = path_to(run, selected);
  std::vector<std::int32_t> next = {0};  // a stack of remaining nodes, the next one on top
  while (!next.empty()) {
    const std::int32_t index = next.back();
    const auto n = static_cast<std::size_t>(index);
    const planes::OctreeNode& node = nodes[n];
    next.pop_back();
    OctreeRow row{index, node.depth, has_born_children(run, index, step), false};
    if (row.has_children) {
      const auto fold = folds.find(index);
      row.open = fold != folds.end() ? fold->second : settled[n] > step || on_path[n] != 0;
    }
    rows.push_back(row);
    for (std::int32_t child = node.child_count; row.open && child-- > 0;)
      next.push_back(node.first_child + child);
  }
  return rows;
}

std::vector<OctreeRow> octree_matches(const debug::Run& run,
                                      std::int32_t step,
                                      const std::string& search,
                                      debug::FilterProblem& problem) {
  problem = {};
  std::vector<OctreeRow> rows;
  const auto add = [&](std::int32_t node) {
    rows.push_back({node, 0, has_born_children(run, node, step), false});
  };
  std::int32_t number = -1;
  const char* end = search.data() + search.size();
  if (const auto [stopped, error] = std::from_chars(search.data(), end, number);
      error == std::errc() && stopped == end) {
    const auto count = static_cast<std::int32_t>(run.octree().nodes.size());
    if (number >= 0 && number < count && is_born(run, number, step)) add(number);
    return rows;
  }
  const auto filter = debug::Filter::parse(search, problem);
  if (!filter) return rows;
  std::vector<std::uint8_t> found(run.octree().nodes.size(), 0);
  for (const std::int32_t match : filter->matching(run)) {
    if (match > step) break;
    if (const std::int32_t node = run.event_at(match)->node; node >= 0)
      found[static_cast<std::size_t>(node)] = 1;
  }
  for (std::size_t n = 0; n < found.size(); ++n)
    if (found[n]) add(static_cast<std::int32_t>(n));
  return rows;
}

SubtreeCounts count_subtree(const debug::Run& run, std::int32_t step, std::int32_t node) {
  // Nodes are in breadth-first order, so those of one depth below a node are contiguous.
  const std::vector<planes::OctreeNode>& nodes = run.octree().nodes;
  SubtreeCounts counts = {};
  std::int32_t begin = node, end = node + 1;
  while (begin < end) {
    std::int32_t first = -1, last = -1;
    for (std::int32_t n = begin; n < end; ++n) {
      const planes::OctreeNode& parent = nodes[static_cast<std::size_t>(n)];
      if (!has_born_children(run, n, step)) continue;
      if (first < 0) first = parent.first_child;
      last = parent.first_child + parent.child_count;
    }
    for (std::int32_t n = first; n < last; ++n) {
      const bool settled = run.timeline.node_state(n, step) == debug::NodeState::settled;
      ++counts[settled ? static_cast<std::size_t>(nodes[static_cast<std::size_t>(n)].decided) : 0];
    }
    begin = first;
    end = last;
  }
  return counts;
}

namespace {

/// Whether the bin is scaled by ratio: on logarithmic axes, except for the part of the first bin
/// below its edge.
bool by_ratio(const debug::Histogram& histogram, const debug::HistogramBin& bin) {
  return histogram.logarithmic && bin.low > 0;
}

}  // namespace

double SliderScale::share(double value) const {
  const double share = logarithmic ? std::log(std::max(value, low) / low) / std::log(high / low)
                                   : (value - low) / (high - low);
  return std::clamp(share, 0.0, 1.0);
}

double SliderScale::value(double share) const {
  const double value = logarithmic ? low * std::pow(high / low, share) : low + share * (high - low);
  // Three significant digits, the precision of a drag.
  if (value == 0) return 0;
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 2);
  return std::round(value / unit) * unit;
}

SliderScale slider_scale(const planes::OptionInfo& info, planes::Profile profile) {
  SliderScale scale;
  scale.standard = parse_number(planes::default_value(info, profile), "option " + info.name);
  const double base = scale.standard > 0                       ? scale.standard
                      : info.kind == planes::OptionKind::whole ? 10
                                                               : 0.02;
  const bool of_size = info.unit == "m" || info.unit == "m2";
  if (info.range.max <= 90 && !of_size) {  // fractions, angles, levels: the full range
    scale.low = info.range.min;
    scale.high = info.range.max;
  } else if (info.kind == planes::OptionKind::whole) {
    scale.low = info.range.min;
    scale.high = 6 * base;
  } else if (scale.standard > 0) {
    scale.logarithmic = true;
    scale.low = std::max(info.range.min, base / 20);
    scale.high = std::min(info.range.max, base * 20);
  } else {  // 0 means off, so use a linear scale, which includes it
    scale.high = std::min(info.range.max, 5 * base);
  }
  return scale;
}

double HistogramAxis::share(double value) const {
  const auto& bins = histogram_.bins;
  const auto at = std::find_if(bins.begin(), bins.end(),
                               [&](const debug::HistogramBin& bin) { return value < bin.high; });
  if (at == bins.end()) return 1;
  if (value <= at->low)
    return at == bins.begin()
               ? 0
               : static_cast<double>(at - bins.begin()) / static_cast<double>(bins.size());
  const double inside = by_ratio(histogram_, *at)
                            ? std::log(value / at->low) / std::log(at->high / at->low)
                            : (value - at->low) / (at->high - at->low);
  return (static_cast<double>(at - bins.begin()) + inside) / static_cast<double>(bins.size());
}

double HistogramAxis::value(double share) const {
  const auto& bins = histogram_.bins;
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(bins.size());
  const std::size_t i = std::min(bins.size() - 1, static_cast<std::size_t>(position));
  const double inside = position - static_cast<double>(i);
  const debug::HistogramBin& bin = bins[i];
  return by_ratio(histogram_, bin) ? bin.low * std::pow(bin.high / bin.low, inside)
                                   : bin.low + inside * (bin.high - bin.low);
}

std::vector<double> axis_ticks(const debug::Histogram& histogram) {
  const auto& bins = histogram.bins;
  if (bins.empty()) return {};
  // The last bin contains all outliers, so its upper end means little.
  const double low = bins.front().low, high = bins.back().low;
  std::vector<double> ticks;
  if (histogram.logarithmic) {
    const double least = std::max(low, bins.front().high / 10);
    if (low <= 0) ticks.push_back(low);
    for (int power = static_cast<int>(std::floor(std::log10(least))); power < 12; ++power)
      if (const double tick = std::pow(10, power); tick >= least && tick <= high)
        ticks.push_back(tick);
  } else if (high > low) {
    const double rough = (high - low) / 4, unit = std::pow(10, std::floor(std::log10(rough)));
    const double step = rough / unit > 5 ? 10 * unit : rough / unit > 2 ? 5 * unit : 2 * unit;
    for (double k = std::ceil(low / step); k * step <= high; ++k) ticks.push_back(k * step);
  }
  return ticks.size() >= 2 ? ticks : std::vector<double>{low, bins.back().high};
}

std::string filter_between(const debug::Histogram& histogram, double from, double to) {
  if (histogram.quantity.empty()) return {};
  const HistogramAxis axis(histogram);
  const double low = axis.value(std::min(from, to)), high = axis.value(std::max(from, to));
  if (histogram.unit == "points")  // integers
    return fmt::format("{0}>={1:.0f} && {0}<{2:.0f}", histogram.quantity, std::floor(low),
                       std::ceil(high));
  return fmt::format("{0}>={1:.3g} && {0}<{2:.3g}", histogram.quantity, low, high);
}

namespace {

constexpr int kShownCompletions = 9;

bool has_problem(const FilterBox& box) { return box.problem && !box.problem->message.empty(); }

/// Empty if the word is complete and no other word begins with it.
std::vector<debug::Completion> completions_at(const std::string& text, int cursor) {
  std::vector<debug::Completion> all =
      debug::complete_filter(text, static_cast<std::size_t>(cursor));
  const auto is_there = [&](const debug::Completion& c) {
    return text.substr(c.begin, c.end - c.begin) == c.insert;
  };
  if (all.size() == 1 && is_there(all[0])) all.clear();
  return all;
}

const debug::Completion* chosen_of(const std::vector<debug::Completion>& all,
                                   const FilterBoxMemory& memory) {
  if (all.empty()) return nullptr;
  const int last = static_cast<int>(all.size()) - 1;
  return &all[static_cast<std::size_t>(std::clamp(memory.chosen, 0, last))];
}

/// Tab inserts the chosen completion; Up and Down choose another.
int on_input(ImGuiInputTextCallbackData* data) {
  auto& memory = *static_cast<FilterBoxMemory*>(data->UserData);
  if (data->EventFlag == ImGuiInputTextFlags_CallbackCompletion) {
    const auto all = completions_at(std::string(data->Buf, data->BufTextLen), data->CursorPos);
    if (const debug::Completion* completion = chosen_of(all, memory)) {
      const int begin = static_cast<int>(completion->begin);
      data->DeleteChars(begin, static_cast<int>(completion->end) - begin);
      data->InsertChars(begin, completion->insert.c_str());
      data->CursorPos = begin + static_cast<int>(completion->insert.size());
      memory.chosen = 0;
    }
  } else if (data->EventFlag == ImGuiInputTextFlags_CallbackHistory) {
    const auto all = completions_at(std::string(data->Buf, data->BufTextLen), data->CursorPos);
    const int last = std::max(0, static_cast<int>(all.size()) - 1);
    const int by = data->EventKey == ImGuiKey_DownArrow ? 1 : -1;
    memory.chosen = std::clamp(memory.chosen + by, 0, last);
  } else {
    if (memory.place_cursor >= 0) {
      data->CursorPos = std::min(memory.place_cursor, data->BufTextLen);
      data->ClearSelection();
      memory.place_cursor = -1;
    }
    if (memory.cursor != data->CursorPos) memory.chosen = 0;
    memory.cursor = data->CursorPos;
  }
  return 0;
}

/// Draws a wavy line under the invalid part.
void underline(const Ui& ui, const FilterBoxMemory& memory, const debug::FilterProblem& problem) {
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  const ImGuiInputTextState* input = ImGui::GetInputTextState(ImGui::GetItemID());
  const float scrolled = input ? scrolled_right(*input) : 0;
  const float left = min.x + ImGui::GetStyle().FramePadding.x - scrolled;
  const auto width_until = [&](std::size_t byte) {
    const char* text = memory.text.c_str();
    return ImGui::CalcTextSize(text, text + std::min(byte, memory.text.size())).x;
  };
  const float from = left + width_until(problem.begin);
  const float to = std::max(left + width_until(problem.end), from + ui.px(6));
  const float y = max.y - ui.px(4), wave = ui.px(1.5f);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(min, max, true);
  for (float x = from; x < to; x += 2 * wave) {
    draw->PathLineTo(ImVec2(x, y));
    draw->PathLineTo(ImVec2(x + wave, y + wave));
  }
  draw->PathStroke(ui.colors.bad, 0, ui.px(1.3f));
  draw->PopClipRect();
}

void take(const Ui& ui,
          const FilterBox& box,
          FilterBoxMemory& memory,
          const debug::Completion& completion) {
  memory.text.replace(completion.begin, completion.end - completion.begin, completion.insert);
  memory.applied = memory.text;
  memory.chosen = 0;
  memory.cursor = memory.place_cursor =
      static_cast<int>(completion.begin + completion.insert.size());
  memory.take_keyboard = true;
  memory.popup_hovered = false;
  ui.act(box.action, memory.text);
}

void draw_popup(const Ui& ui, const FilterBox& box, FilterBoxMemory& memory) {
  const std::vector<debug::Completion> all = completions_at(memory.text, memory.cursor);
  if (all.empty()) {
    memory.popup_hovered = false;
    return;
  }
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  const int rows = std::min(kShownCompletions, static_cast<int>(all.size()));
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const float height =
      static_cast<float>(rows) * line + 2 * ImGui::GetStyle().WindowPadding.y - ui.px(2);
  const bool above = max.y + line + height > ImGui::GetIO().DisplaySize.y;
  const float below = max.y + (has_problem(box) ? line : 0) + ui.px(2);  // keep the error visible
  float widest = 0;
  for (const debug::Completion& completion : all)
    widest = std::max(widest, ImGui::CalcTextSize(completion.meaning.c_str()).x);
  const float width = std::min(ui.px(175) + widest, ImGui::GetIO().DisplaySize.x);
  const float left = std::min(min.x, ImGui::GetIO().DisplaySize.x - width);
  ImGui::SetNextWindowPos(ImVec2(left, above ? min.y - height - ui.px(2) : below));
  ImGui::SetNextWindowSize(ImVec2(width, height));
  ImGui::Begin(("##completions." + box.widget).c_str(), nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNav);
  ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
  memory.popup_hovered = ImGui::IsWindowHovered();
  const debug::Completion* chosen = chosen_of(all, memory);
  const debug::Completion* taken = nullptr;
  for (const debug::Completion& completion : all) {
    const bool is_chosen = &completion == chosen;
    ImGui::PushID(&completion);
    if (ImGui::Selectable("##take", is_chosen, ImGuiSelectableFlags_SelectOnClick))
      taken = &completion;
    ImGui::PopID();
    ui.name(box.widget + ".completion." + completion.insert);
    if (is_chosen && !memory.popup_hovered) ImGui::SetScrollHereY();
    ImGui::SameLine(ui.px(10));
    ImGui::TextUnformatted(completion.insert.c_str());
    ImGui::SameLine(ui.px(150));
    ImGui::TextDisabled("%s", completion.meaning.c_str());
  }
  ImGui::End();
  if (taken) take(ui, box, memory, *taken);
}

}  // namespace

void draw_filter_box(const Ui& ui, const FilterBox& box, float width) {
  FilterBoxMemory& memory = ui.memory.filter_boxes[box.widget];
  const std::string label = "##" + box.widget;
  if (memory.applied != box.text) {
    memory.text = memory.applied = box.text;
    if (ImGui::GetActiveID() == ImGui::GetID(label.c_str())) ImGui::ClearActiveID();
  }
  if (ui.state.view.focus == box.widget || memory.take_keyboard) ImGui::SetKeyboardFocusHere();
  memory.take_keyboard = false;
  ImGui::SetNextItemWidth(width);
  const bool edited = ImGui::InputTextWithHint(label.c_str(), box.hint.c_str(), &memory.text,
                                               ImGuiInputTextFlags_CallbackAlways |
                                                   ImGuiInputTextFlags_CallbackCompletion |
                                                   ImGuiInputTextFlags_CallbackHistory,
                                               on_input, &memory);
  ui.name(box.widget);
  const bool active = ImGui::IsItemActive();
  const bool entered = ImGui::IsItemDeactivated() && went_down(ImGuiKey_Enter);
  if (has_problem(box) && memory.text == box.text) underline(ui, memory, *box.problem);
  if (edited) {
    memory.applied = memory.text;
    ui.act(box.action, memory.text);
  }
  if (entered && !box.on_enter.empty()) ui.act(box.on_enter);
  if (active || (memory.popup_hovered && !entered))
    draw_popup(ui, box, memory);
  else
    memory.popup_hovered = false;
}

}  // namespace planescope::desktop
