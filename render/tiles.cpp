#include "render/tiles.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::render {
namespace {

constexpr int kTile_px = 32;  // a few letters: what changes is seldom smaller

int tiles_along(int length_px) { return (length_px + kTile_px - 1) / kTile_px; }

}  // namespace

int whole_px(double place) {
  constexpr double kFar = 1e6;
  return std::isnan(place) ? 0 : static_cast<int>(std::clamp(place, -kFar, kFar));
}

Part common(const Part& a, const Part& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

Part around(const Part& a, const Part& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

std::vector<Part> at_most(std::vector<Part> parts, std::size_t count) {
  const auto smaller = [](const Part& a, const Part& b) { return a.pixels() < b.pixels(); };
  while (parts.size() > count) {
    std::iter_swap(std::min_element(parts.begin(), parts.end(), smaller), parts.end() - 1);
    const Part least = parts.back();
    parts.pop_back();
    const auto growth = [&](const Part& part) {
      return around(part, least).pixels() - part.pixels();
    };
    const auto host =
        std::min_element(parts.begin(), parts.end(),
                         [&](const Part& a, const Part& b) { return growth(a) < growth(b); });
    *host = around(*host, least);
  }
  return parts;
}

std::vector<Part> apart(std::vector<Part> parts, int reach_px) {
  for (std::size_t i = 0; i < parts.size();) {
    const Part near{parts[i].x0 - reach_px, parts[i].y0 - reach_px, parts[i].x1 + reach_px,
                    parts[i].y1 + reach_px};
    const auto other = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
      return &part != &parts[i] && !common(near, part).empty();
    });
    if (other == parts.end()) {
      ++i;
      continue;
    }
    *other = around(*other, parts[i]);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
  return parts;
}

Tiles::Tiles(int width, int height)
    : width_(width),
      height_(height),
      hashes_(static_cast<std::size_t>(tiles_along(width)) * tiles_along(height)) {}

void Tiles::add(const Part& touched, std::uint64_t hash) {
  const Part part = common(touched, {0, 0, width_, height_});
  if (part.empty()) return;
  const int columns = tiles_along(width_);
  for (int y = part.y0 / kTile_px; y <= (part.y1 - 1) / kTile_px; ++y)
    for (int x = part.x0 / kTile_px; x <= (part.x1 - 1) / kTile_px; ++x) {
      std::uint64_t& tile = hashes_[static_cast<std::size_t>(y) * columns + x];
      tile = hashed(tile, hash);
    }
}

std::vector<Part> Tiles::changes_since(const Tiles& before) const {
  if (before.width_ != width_ || before.height_ != height_) return {{0, 0, width_, height_}};
  const int columns = tiles_along(width_), rows = tiles_along(height_);
  const auto differs = [&](int x, int y) {
    const std::size_t i = static_cast<std::size_t>(y) * columns + x;
    return hashes_[i] != before.hashes_[i];
  };
  // Tiles side by side make one part, and so do rows of them that are alike.
  std::vector<Part> parts;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (!differs(x, y)) continue;
      const int first = x;
      while (x < columns && differs(x, y)) ++x;
      const Part run{first * kTile_px, y * kTile_px, std::min(x * kTile_px, width_),
                     std::min((y + 1) * kTile_px, height_)};
      const auto above = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
        return part.y1 == run.y0 && part.x0 == run.x0 && part.x1 == run.x1;
      });
      if (above == parts.end())
        parts.push_back(run);
      else
        above->y1 = run.y1;
    }
  }
  return parts;
}

}  // namespace planescope::render
