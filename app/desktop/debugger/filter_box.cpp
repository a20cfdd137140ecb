#include "app/desktop/debugger/filter_box.hpp"

#include <algorithm>

#include "app/desktop/imgui.hpp"
#include "app/desktop/ui.hpp"

namespace planescope::desktop {
namespace {

constexpr int kShownCompletions = 9;

bool has_problem(const FilterBox& box) { return box.problem && !box.problem->message.empty(); }

/// Nothing where the word is whole and nothing else begins with it.
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

/// Tab takes the chosen completion, Up and Down choose another.
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

/// A wavy line under the part that is wrong.
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
  const float below = max.y + (has_problem(box) ? line : 0) + ui.px(2);  // what is wrong stays read
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
