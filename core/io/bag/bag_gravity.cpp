#include "core/io/bag/bag_gravity.hpp"

#include <algorithm>
#include <set>

#include "core/io/bag/ros_messages.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace {

constexpr std::size_t kMaxSamples = 64;
// Samples are spread over the recording, and each compressed chunk they lie in is unpacked.
constexpr std::size_t kMaxCost = 4 << 20;

}  // namespace

std::optional<Gravity> gravity_near(const MessageLog& bag,
                                    const std::vector<MessageRef>& accel,
                                    std::uint64_t time_ns,
                                    const Mat3d& R_depth_accel) {
  const auto gap_ns = [&](std::size_t i) {
    return accel[i].time_ns > time_ns ? accel[i].time_ns - time_ns : time_ns - accel[i].time_ns;
  };
  auto after = static_cast<std::size_t>(
      std::lower_bound(accel.begin(), accel.end(), time_ns,
                       [](const MessageRef& m, std::uint64_t t) { return m.time_ns < t; }) -
      accel.begin());
  std::size_t before = after;  // [before, after) are the samples taken
  std::set<std::pair<std::uint32_t, std::uint32_t>> chunks;  // file, number
  std::size_t cost = 0;
  Vec3d sum = Vec3d::Zero();
  std::uint64_t widest_ns = 0;
  std::size_t count = 0;
  while (count < kMaxSamples && (before > 0 || after < accel.size())) {
    const bool earlier =
        before > 0 && (after == accel.size() || gap_ns(before - 1) <= gap_ns(after));
    const std::size_t i = earlier ? --before : after++;
    if (chunks.insert({accel[i].file, accel[i].chunk}).second) cost += bag.unpacking_cost(accel[i]);
    if (count > 0 && cost > kMaxCost) break;
    try {
      const auto sample = ros::parse_imu(bag.read(accel[i]));
      if (!sample.meters_per_s2.allFinite()) continue;
      sum += sample.meters_per_s2;
    } catch (OutOfBytes) {
      continue;
    } catch (const Error&) {
      continue;  // a damaged chunk; the others decide
    }
    widest_ns = gap_ns(i);
    ++count;
  }
  if (count == 0) return std::nullopt;
  const Vec3d mean = sum / static_cast<double>(count);
  return gravity_of_accelerometer(R_depth_accel * mean, count,
                                  1e-9 * static_cast<double>(widest_ns));
}

}  // namespace planescope::io
