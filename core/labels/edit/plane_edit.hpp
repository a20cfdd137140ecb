#pragma once

// What the operations on planes share. Internal to core/labels.

#include "core/labels/edit/operations.hpp"

namespace planescope::labels {

/// Throws Error where there is no such plane, or it is locked.
LabelPlane& editable_plane(FrameLabels& labels, int id);
/// Keeps the list in order of id.
LabelPlane& add_plane(FrameLabels& labels, const LabelPlane& plane);

}  // namespace planescope::labels
