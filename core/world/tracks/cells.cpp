#include "core/world/tracks/cells.hpp"

namespace planescope::world {
namespace {

int floor_div(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

std::int64_t key_of(int tile_x, int tile_y) {
  return (static_cast<std::int64_t>(tile_x) << 32) ^ static_cast<std::uint32_t>(tile_y);
}

}  // namespace

void Cell::look(bool is_through) {
  if (looked >= kHorizon) {
    looked /= 2;
    seen = seen > 1 ? seen / 2 : seen;
  }
  ++looked;
  through = is_through ? static_cast<std::uint8_t>(through + 1) : std::uint8_t{0};
  if (through >= kGone) *this = {.gone = gone || seen > 0};
}

void Cell::see() {
  if (seen < kHorizon) ++seen;
  if (looked < seen) looked = seen;
  through = 0;
  gone = false;
}

Cell& CellMap::at(int x, int y) {
  const int tile_x = floor_div(x, kSide), tile_y = floor_div(y, kSide);
  const auto [at, is_new] =
      index_.try_emplace(key_of(tile_x, tile_y), static_cast<std::uint32_t>(tiles_.size()));
  if (is_new) tiles_.push_back({tile_x, tile_y, {}});
  return tiles_[at->second].cells[(y - tile_y * kSide) * kSide + (x - tile_x * kSide)];
}

const Cell* CellMap::find(int x, int y) const {
  const int tile_x = floor_div(x, kSide), tile_y = floor_div(y, kSide);
  const auto at = index_.find(key_of(tile_x, tile_y));
  if (at == index_.end()) return nullptr;
  return &tiles_[at->second].cells[(y - tile_y * kSide) * kSide + (x - tile_x * kSide)];
}

std::vector<CellMap::Tile> CellMap::take_out(const std::function<bool(const Tile&)>& leaves) {
  std::vector<Tile> left, stay;
  for (Tile& tile : tiles_) (leaves(tile) ? left : stay).push_back(tile);
  if (left.empty()) return left;
  tiles_ = std::move(stay);
  index_.clear();
  for (std::size_t i = 0; i < tiles_.size(); ++i)
    index_[key_of(tiles_[i].x, tiles_[i].y)] = static_cast<std::uint32_t>(i);
  return left;
}

bool CellMap::is_near(int x, int y, int radius) const {
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx)
      if (const Cell* cell = find(x + dx, y + dy); cell && cell->present()) return true;
  return false;
}

std::size_t CellMap::present() const {
  std::size_t count = 0;
  for (const Tile& tile : tiles_)
    for (const Cell& cell : tile.cells) count += cell.present();
  return count;
}

template <typename Which>
std::vector<Vec2d> CellMap::places(const Which& which) const {
  std::vector<Vec2d> places;
  for (const Tile& tile : tiles_)
    for (int i = 0; i < kSide * kSide; ++i)
      if (which(tile.cells[i])) places.push_back(middle(tile, i));
  return places;
}

std::vector<Vec2d> CellMap::sure_places() const {
  return places([](const Cell& cell) { return cell.sure(); });
}
std::vector<Vec2d> CellMap::gone_places() const {
  return places([](const Cell& cell) { return cell.gone; });
}

}  // namespace planescope::world
