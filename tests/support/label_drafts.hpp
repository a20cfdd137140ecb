#pragma once

// Labels after an operation of the label tools.

#include <gtest/gtest.h>

#include <span>
#include <type_traits>

#include "core/labels/edit/operations.hpp"

namespace planescope::labels {

/// Applies an operation with fitted planes, and expects that its edit is the complete difference.
template <typename Result, typename... Args>
FrameLabels edited(const FrameLabels& before,
                   const LabelGrid& grid,
                   Result (*operation)(LabelDraft&, Args...),
                   std::type_identity_t<Args>... args) {
  LabelDraft draft(before);
  operation(draft, args...);
  fit_planes(draft, grid);
  EXPECT_EQ(draft.edit(0, "").runs, make_edit(0, "", before, draft.labels).runs);
  return draft.labels;
}

inline FrameLabels painted(const FrameLabels& before,
                           const LabelGrid& grid,
                           std::span<const std::uint32_t> pixels,
                           const Paint& what,
                           PaintMode mode) {
  return edited(before, grid, paint, grid, pixels, what, mode);
}

}  // namespace planescope::labels
