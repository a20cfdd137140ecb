#pragma once

// What of a plane has been seen: a grid on it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/planes/outline/outline.hpp"

namespace planescope::world {

/// A cell's history, over the last kHorizon looks at it.
struct Cell {
  std::uint8_t seen = 0;     // it was part of the plane
  std::uint8_t looked = 0;   // something was measured there, and nothing stood before it
  std::uint8_t through = 0;  // the last looks went through it, without a break
  bool gone = false;         // so many did that it is not there any more

  static constexpr int kHorizon = 64;
  static constexpr int kGone = 5;       // looks through: it is not there any more
  static constexpr int kLeastSeen = 2;  // of an edge, one outline in many takes too much
  static constexpr double kLeastShare = 0.3;

  void look(bool is_through);
  void see();
  /// Part of the plane as far as anybody knows.
  bool present() const { return seen > 0; }
  /// Seen often enough, for as often as it was looked at.
  bool sure() const { return seen >= kLeastSeen && seen >= kLeastShare * looked; }
};

/// Cells of a plane by their place in it, in tiles; x and y count cells from the plane's origin.
class CellMap {
 public:
  static constexpr int kSide = 16;  // cells along a tile

  struct Tile {
    int x = 0, y = 0;  // [tiles]
    std::array<Cell, kSide * kSide> cells;
  };

  explicit CellMap(double cell_m) : cell_m_(cell_m) {}

  double cell_m() const { return cell_m_; }
  Vec2d middle(const Tile& tile, int i) const {
    return cell_m_ * Vec2d(tile.x * kSide + i % kSide + 0.5, tile.y * kSide + i / kSide + 0.5);
  }
  std::vector<Tile>& tiles() { return tiles_; }  // in order of first appearance
  const std::vector<Tile>& tiles() const { return tiles_; }

  /// Takes out the tiles for which `leaves` holds, in their order.
  std::vector<Tile> take_out(const std::function<bool(const Tile&)>& leaves);
  static constexpr double kTileRadius = 0.7072 * kSide;  // [cells], about a tile's middle
  Vec2d middle(const Tile& tile) const {
    return cell_m_ * kSide * Vec2d(tile.x + 0.5, tile.y + 0.5);
  }

  Cell& at(int x, int y);                // made where it is missing
  const Cell* find(int x, int y) const;  // null where it is missing
  int index_of(double metres) const { return whole(std::floor(metres / cell_m_)); }

  /// Calls visit(x, y) for the cells whose middles are inside rings, by the rule of even and odd.
  template <typename Visit>
  void fill(std::span<const planes::PolygonRing> rings, const Visit& visit) const;
  /// Whether a present cell is within `radius` cells of this one.
  bool is_near(int x, int y, int radius) const;

  std::size_t present() const;
  /// Middles of the cells that are sure, and of those that are gone; in order.
  std::vector<Vec2d> sure_places() const;
  std::vector<Vec2d> gone_places() const;

 private:
  /// A count of cells as an int; what no plane reaches ends at the border.
  static int whole(double cells) {
    constexpr double kMost = 1 << 30;
    return static_cast<int>(cells > -kMost ? std::min(cells, kMost) : -kMost);
  }
  template <typename Which>
  std::vector<Vec2d> places(const Which& which) const;

  double cell_m_;
  std::vector<Tile> tiles_;
  std::unordered_map<std::int64_t, std::uint32_t> index_;
};

// ---- Of the template ----

template <typename Visit>
void CellMap::fill(std::span<const planes::PolygonRing> rings, const Visit& visit) const {
  struct Crossing {
    int y;
    double x;
    auto operator<=>(const Crossing&) const = default;
  };
  std::vector<Crossing> crossings;
  for (const planes::PolygonRing& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2d a = ring[i] / cell_m_, b = ring[(i + 1) % ring.size()] / cell_m_;
      const int first = whole(std::ceil(std::min(a.y(), b.y()) - 0.5));
      const int end = whole(std::ceil(std::max(a.y(), b.y()) - 0.5));
      for (int y = first; y < end; ++y)
        crossings.push_back({y, a.x() + (b.x() - a.x()) * (y + 0.5 - a.y()) / (b.y() - a.y())});
    }
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const int end = whole(std::ceil(crossings[i + 1].x - 0.5));
    for (int x = whole(std::ceil(crossings[i].x - 0.5)); x < end; ++x) visit(x, crossings[i].y);
  }
}

}  // namespace planescope::world
