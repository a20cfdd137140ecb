#include <fmt/format.h>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

/// Where it leads, as far as its name does not say so already.
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
                     "A bookmark stores frame, step, selection, filter and "
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
    // Typed text is the panel's until it is done.
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
