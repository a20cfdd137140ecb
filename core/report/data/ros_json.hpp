#pragma once

// A frame's planes as the messages of packaging/ros2/planescope_msgs have them.

#include <string>

#include "core/model/frame.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::report {

/// planescope_msgs/PlaneArray as one line of JSON, with the message's fields, all of them, and no
/// others.
std::string ros_json(const Frame& frame,
                     const planes::FrameResult& result,
                     const planes::FramePlanes& found);

}  // namespace planescope::report
