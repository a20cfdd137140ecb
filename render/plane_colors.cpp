#include "render/plane_colors.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <tuple>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"

namespace planescope::render {
namespace {

constexpr std::size_t kColors = kPlaneColors;

std::vector<std::vector<int>> neighbors_of(const PlaneImage& planes) {
  std::vector<std::vector<int>> neighbors(planes.planes.size());
  for (const auto& [a, b] : planes.touching) {
    neighbors[static_cast<std::size_t>(a) - 1].push_back(b - 1);
    neighbors[static_cast<std::size_t>(b) - 1].push_back(a - 1);
  }
  return neighbors;
}

/// For a plane that has none: see settle_colors(). Of equal ones the first of the palette.
int new_color(const PlaneImage& planes,
              const std::vector<int>& colors,
              const std::vector<int>& neighbors,
              const std::array<bool, kColors>& reserved) {
  struct Use {
    std::size_t touching = 0, anywhere = 0;
    bool reserved = false;
    auto operator<=>(const Use&) const = default;
  };
  std::array<Use, kColors> uses;
  for (std::size_t i = 0; i < colors.size(); ++i)
    if (colors[i] > 0) uses[static_cast<std::size_t>(colors[i]) - 1].anywhere += 1;
  for (const int i : neighbors)
    if (const int color = colors[static_cast<std::size_t>(i)]; color > 0)
      uses[static_cast<std::size_t>(color) - 1].touching +=
          planes.planes[static_cast<std::size_t>(i)].size;
  for (std::size_t c = 0; c < kColors; ++c) uses[c].reserved = reserved[c];
  return static_cast<int>(std::ranges::min_element(uses) - uses.begin()) + 1;
}

}  // namespace

std::vector<int> ColoredPlanes::own_colors() const {
  const auto own = std::ranges::count(unseen, 0);
  return {colors.begin(), colors.begin() + own};
}

std::vector<int> settle_colors(const PlaneImage& planes,
                               std::vector<int> wanted,
                               const std::vector<int>& reserved) {
  wanted.resize(planes.planes.size(), 0);
  for (int& color : wanted)
    if (color > 0) color = (color - 1) % kPlaneColors + 1;
  std::array<bool, kColors> is_reserved{};
  for (const int color : reserved) is_reserved[static_cast<std::size_t>(color) - 1] = true;
  const std::vector<std::vector<int>> neighbors = neighbors_of(planes);
  std::vector<int> by_size(wanted.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  const auto size_of = [&](int i) { return planes.planes[static_cast<std::size_t>(i)].size; };
  std::ranges::stable_sort(by_size, std::greater(), size_of);

  std::vector<int> colors(wanted.size(), 0);
  const auto touches = [&](int i, int color) {
    return std::ranges::any_of(neighbors[static_cast<std::size_t>(i)], [&](int other) {
      return colors[static_cast<std::size_t>(other)] == color;
    });
  };
  for (const int i : by_size)
    if (const int color = wanted[static_cast<std::size_t>(i)]; color > 0 && !touches(i, color))
      colors[static_cast<std::size_t>(i)] = color;
  for (const int i : by_size) {
    int& color = colors[static_cast<std::size_t>(i)];
    if (color > 0) continue;
    const int found =
        new_color(planes, colors, neighbors[static_cast<std::size_t>(i)], is_reserved);
    // Smaller neighbors give it up, and get another color in their turn.
    for (const int other : neighbors[static_cast<std::size_t>(i)])
      if (int& theirs = colors[static_cast<std::size_t>(other)];
          theirs == found && std::tuple(size_of(i), other) > std::tuple(size_of(other), i))
        theirs = 0;
    color = found;
  }
  return colors;
}

ColoredPlanes color_planes(PlaneImage now, const ColoredPlanes* before) {
  ColoredPlanes colored;
  colored.image = std::move(now);
  const std::size_t own = colored.image.planes.size();
  colored.unseen.assign(own, 0);
  if (!before) {
    colored.colors = settle_colors(colored.image, {});
    return colored;
  }
  const PlaneMatch match = match_planes(before->image, colored.image);
  std::vector<int> wanted(own, 0);
  std::vector<std::uint8_t> goes_on(before->colors.size(), 0);
  for (std::size_t i = 0; i < own; ++i) {
    const int from = match.before_of[i] > 0 ? match.before_of[i] : match.piece_of[i];
    if (from == 0) continue;
    wanted[i] = before->colors[static_cast<std::size_t>(from) - 1];
    goes_on[static_cast<std::size_t>(from) - 1] = 1;
  }
  std::vector<int> remembered;
  std::vector<PlaneInView> lost;
  for (std::size_t b = 0; b < goes_on.size(); ++b) {
    if (goes_on[b] || before->unseen[b] >= kRememberedFrames) continue;
    remembered.push_back(before->colors[b]);
    colored.unseen.push_back(before->unseen[b] + 1);
    lost.push_back(moved(before->image.planes[b], match.T_now_before));
  }
  colored.colors = settle_colors(colored.image, std::move(wanted), remembered);
  colored.image.planes.insert(colored.image.planes.end(), lost.begin(), lost.end());
  colored.colors.insert(colored.colors.end(), remembered.begin(), remembered.end());
  return colored;
}

std::vector<int> first_colors(const planes::FrameResult& result) {
  return settle_colors(plane_image(result), {});
}

std::vector<int> true_plane_colors(const PlaneImage& truth,
                                   std::span<const int> found_of,
                                   std::span<const int> colors) {
  std::vector<int> wanted;
  for (const int found : found_of) wanted.push_back(found == 0 ? 0 : color_id_of(found, colors));
  return settle_colors(truth, std::move(wanted));
}

std::vector<int> trace_colors(const debug::Run& run, std::span<const int> colors) {
  std::vector<int> others;
  for (int color = 1; color <= kPlaneColors; ++color)
    if (std::ranges::find(colors, color) == colors.end()) others.push_back(color);
  std::vector<int> of_trace;
  std::size_t passing = 0;
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane) {
    const std::int32_t id = run.timeline.result_of_plane(plane);
    if (id > 0)
      of_trace.push_back(color_id_of(id, colors));
    else
      of_trace.push_back(others.empty() ? plane + 1 : others[passing++ % others.size()]);
  }
  return of_trace;
}

}  // namespace planescope::render
