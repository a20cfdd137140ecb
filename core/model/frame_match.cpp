// Matches frames by pixels, name and time.

#include "core/model/frame_match.hpp"

#include <fmt/format.h>

#include <deque>
#include <map>

namespace planescope {

std::vector<int> match_frames(std::span<const FrameIdentity> before,
                              std::span<const FrameIdentity> now) {
  std::vector<int> partners(now.size(), -1);
  std::vector<bool> matched(before.size(), false);
  const auto match = [&](std::size_t k, int position) {
    partners[k] = position;
    matched[static_cast<std::size_t>(position)] = true;
  };
  // Frames whose keys are equal, in order; an empty key matches nothing.
  const auto match_by = [&](const auto& key_of) {
    std::map<std::string, std::deque<int>> open;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (const std::string key = key_of(before[i]); !key.empty() && !matched[i])
        open[key].push_back(static_cast<int>(i));
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (partners[k] >= 0) continue;
      const auto found = open.find(key_of(now[k]));
      if (found == open.end() || found->second.empty()) continue;
      match(k, found->second.front());
      found->second.pop_front();
    }
  };
  match_by([](const FrameIdentity& f) { return f.sha256.empty() ? "" : f.sha256 + "/" + f.name; });
  match_by([](const FrameIdentity& f) { return f.sha256; });
  match_by([](const FrameIdentity& f) { return f.name; });
  match_by([](const FrameIdentity& f) {
    return f.timestamp_s == 0 ? std::string() : fmt::format("{}", f.timestamp_s);
  });
  for (std::size_t k = 0; k < now.size(); ++k)
    for (std::size_t i = 0; i < before.size() && partners[k] < 0; ++i)
      if (before[i].index == now[k].index && !matched[i] &&
          (before[i].name.empty() || now[k].name.empty()))
        match(k, static_cast<int>(i));
  return partners;
}

}  // namespace planescope
