#include "app/desktop/debugger/panels/node_shapes.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

/// Corners of a regular polygon, the first at `turn` of a full turn from the right.
void polygon(ImDrawList* draw, ImVec2 centre, float radius, int corners, float turn, ImU32 color) {
  for (int i = 0; i < corners; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> *
                        (turn + static_cast<float>(i) / static_cast<float>(corners));
    draw->PathLineTo(
        ImVec2(centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)));
  }
  draw->PathFillConvex(color);
}

void fill_case(ImDrawList* draw, ImVec2 centre, float radius, planes::Case decided, ImU32 color) {
  switch (decided) {
    case planes::Case::none:
      break;
    case planes::Case::I:
      draw->AddCircleFilled(centre, radius, color, 20);
      break;
    case planes::Case::II:
      polygon(draw, centre, radius * 1.15f, 4, 0.125f, color);
      break;
    case planes::Case::III:
      polygon(draw, centre, radius * 1.1f, 6, 0, color);
      break;
    case planes::Case::IV:
      polygon(draw, centre, radius * 1.2f, 4, 0, color);
      break;
  }
}

void hatch(const Ui& ui, ImDrawList* draw, ImVec2 c, float r) {
  for (const float shift : {-0.55f, 0.0f, 0.55f})
    draw->AddLine(ImVec2(c.x + (shift - 0.6f) * r, c.y + (shift + 0.6f) * r),
                  ImVec2(c.x + (shift + 0.6f) * r, c.y + (shift - 0.6f) * r), ui.colors.panel,
                  ui.px(1.4f));
}

}  // namespace

void draw_node_shape(const Ui& ui, ImVec2 centre, float radius, const NodeShape& shape) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  if (shape.state == debug::NodeState::queued) {
    draw->AddCircle(centre, radius * 0.85f, ui.colors.muted, 20, ui.px(1.3f));
  } else if (shape.state == debug::NodeState::visited) {
    draw->AddCircle(centre, radius * 0.85f, ui.colors.accent, 20, ui.px(2));
    draw->AddCircleFilled(centre, radius * 0.4f, ui.colors.accent, 12);
  } else if (shape.state == debug::NodeState::settled) {
    fill_case(draw, centre, radius, shape.decided, to_imgui(render::case_color(shape.decided)));
    if (shape.at_max_depth) hatch(ui, draw, centre, radius);
    if (shape.impure_fit) draw->AddCircleFilled(centre, radius * 0.4f, ui.colors.panel, 10);
  }
}

void draw_shape_key(const Ui& ui) {
  struct Entry {
    NodeShape shape;
    const char* name;
    const char* meaning;
  };
  const debug::NodeState settled = debug::NodeState::settled;
  const std::array<Entry, 7> entries = {{
      {{debug::NodeState::queued}, "queued", "waits in the queue Q_N"},
      {{settled, planes::Case::I}, "I", "case I, impure: divided"},
      {{settled, planes::Case::II},
       "II",
       "case II, too few inliers: a dead end, its points are left over"},
      {{settled, planes::Case::III}, "III", "case III, not planar: divided"},
      {{settled, planes::Case::IV}, "IV", "case IV: a plane candidate"},
      {{settled, planes::Case::III, true}, "deepest", "I or III at the deepest level: left over"},
      {{settled, planes::Case::I, false, true},
       "R4",
       "R4 fitted each label's points instead of dividing"},
  }};
  const float line = ImGui::GetTextLineHeight();
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  bool first = true;
  for (const Entry& entry : entries) {
    const float width = line + ImGui::CalcTextSize(entry.name).x + ui.px(2);
    if (!first) ImGui::SameLine(0, ui.px(9));
    first = false;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    if (at.x + width > right) {  // a narrow panel shows the first ones
      ImGui::NewLine();
      return;
    }
    ImGui::Dummy(ImVec2(width, line));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", entry.meaning);
    draw_node_shape(ui, ImVec2(at.x + line * 0.4f, at.y + line * 0.5f), line * 0.34f, entry.shape);
    ImGui::GetWindowDrawList()->AddText(ImVec2(at.x + line, at.y), ui.colors.muted, entry.name);
  }
}

}  // namespace planescope::desktop
