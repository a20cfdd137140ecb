#pragma once

#include <string>

#include "core/labels/model/label_files.hpp"

namespace planescope::labels {

/// Everything of FrameLabels but its two images, as JSON text of schema "planescope.labels/1".
std::string label_json(int frame_index, const FrameLabels& labels);

/// The reverse; `where` names the file in messages. Throws Error on anything that is not such a
/// text of this frame.
FrameLabels parse_label_json(const std::string& text, int frame_index, const std::string& where);

/// Throws Error unless the images have one channel, the same size and that of the intrinsics, the
/// plane ids are distinct and in 1..65534, every id in the image is listed, the h/v values are
/// known ones, all numbers are finite, confidences are 0..1 and review notes are about pixels of
/// the image. `where` opens the message.
void check_labels(const FrameLabels& labels, const std::string& where);

}  // namespace planescope::labels
