#pragma once

#include <optional>
#include <vector>

#include "core/io/bag/message_log.hpp"
#include "core/model/frame.hpp"

namespace planescope::io {

/// Gravity from the accelerometer samples recorded nearest to `time_ns`: at rest it measures the
/// reaction to gravity, so things fall along the negative of their mean. nullopt where there are
/// no samples or their mean is not near 1 g (shaken, or damaged). `accel` is sorted by time.
std::optional<Gravity> gravity_near(const MessageLog& bag,
                                    const std::vector<MessageRef>& accel,
                                    std::uint64_t time_ns,
                                    const Mat3d& R_depth_accel);

}  // namespace planescope::io
