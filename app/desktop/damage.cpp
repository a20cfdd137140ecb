#include "app/desktop/damage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace planescope::desktop {
namespace {

constexpr int kTile_px = 32;  // a few letters: what changes is seldom smaller

Part common(const Part& a, const Part& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// The pixels that a command may touch, rounded as ImGui's OpenGL renderer rounds them.
Part scissor(const ImVec4& clip, int height) {
  const int left = static_cast<int>(clip.x);
  const int below = static_cast<int>(static_cast<float>(height) - clip.w);
  const int w = static_cast<int>(clip.z - clip.x), h = static_cast<int>(clip.w - clip.y);
  return {left, height - below - h, left + w, height - below};
}

using Triangle = std::array<ImDrawVert, 3>;

/// The pixels that it may touch.
Part bounds(const Triangle& t) {
  const auto [x0, x1] = std::minmax({t[0].pos.x, t[1].pos.x, t[2].pos.x});
  const auto [y0, y1] = std::minmax({t[0].pos.y, t[1].pos.y, t[2].pos.y});
  return {static_cast<int>(std::floor(x0)), static_cast<int>(std::floor(y0)),
          static_cast<int>(std::ceil(x1)), static_cast<int>(std::ceil(y1))};
}

/// Commands in their order, with the pixels that each may touch.
template <typename Visit>
void each_command(const ImDrawData& frame, Visit visit) {
  const int width = static_cast<int>(frame.DisplaySize.x);
  const int height = static_cast<int>(frame.DisplaySize.y);
  for (int i = 0; i < frame.CmdListsCount; ++i) {
    const ImDrawList& list = *frame.CmdLists[i];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const Part room = common(scissor(command.ClipRect, height), {0, 0, width, height});
      if (!room.empty()) visit(list, command, room);
    }
  }
}

template <typename Visit>
void each_triangle(const ImDrawList& list, const ImDrawCmd& command, Visit visit) {
  const ImDrawVert* vertices = list.VtxBuffer.Data + command.VtxOffset;
  const ImDrawIdx* index = list.IdxBuffer.Data + command.IdxOffset;
  for (unsigned i = 0; i + 2 < command.ElemCount; i += 3)
    visit(Triangle{vertices[index[i]], vertices[index[i + 1]], vertices[index[i + 2]]});
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9e3779b97f4a7c15;
  return hash ^ (hash >> 29);
}

template <typename T>
std::uint64_t mixed_bytes(std::uint64_t hash, const T& value) {
  static_assert(sizeof(T) % 4 == 0);
  std::array<std::uint32_t, sizeof(T) / 4> words;
  std::memcpy(words.data(), &value, sizeof(T));
  for (const std::uint32_t word : words) hash = mixed(hash, word);
  return hash;
}

int tiles_along(int length_px) { return (length_px + kTile_px - 1) / kTile_px; }

/// Tiles side by side make one part, and so do rows of them that are alike.
std::vector<Part> joined(const std::vector<std::uint8_t>& differs, int width, int height) {
  const int columns = tiles_along(width), rows = tiles_along(height);
  const auto at = [&](int x, int y) { return differs[static_cast<std::size_t>(y) * columns + x]; };
  std::vector<Part> parts;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (!at(x, y)) continue;
      const int first = x;
      while (x < columns && at(x, y)) ++x;
      const Part run{first * kTile_px, y * kTile_px, std::min(x * kTile_px, width),
                     std::min((y + 1) * kTile_px, height)};
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

}  // namespace

std::vector<Part> Damage::next(const ImDrawData& frame,
                               const std::function<std::uint64_t(ImTextureID)>& version) {
  const int width = static_cast<int>(frame.DisplaySize.x);
  const int height = static_cast<int>(frame.DisplaySize.y);
  const int columns = tiles_along(width);
  std::vector<std::uint64_t> tiles(static_cast<std::size_t>(columns) * tiles_along(height));
  each_command(frame, [&](const ImDrawList& list, const ImDrawCmd& command, const Part& room) {
    const std::uint64_t texture = reinterpret_cast<std::uintptr_t>(command.GetTexID());
    const std::uint64_t start =
        mixed(mixed(mixed_bytes(1, room), texture), version(command.GetTexID()));
    each_triangle(list, command, [&](const Triangle& triangle) {
      const Part touched = common(bounds(triangle), room);
      if (touched.empty()) return;
      const std::uint64_t hash = mixed_bytes(start, triangle);
      for (int y = touched.y0 / kTile_px; y <= (touched.y1 - 1) / kTile_px; ++y)
        for (int x = touched.x0 / kTile_px; x <= (touched.x1 - 1) / kTile_px; ++x) {
          std::uint64_t& tile = tiles[static_cast<std::size_t>(y) * columns + x];
          tile = mixed(tile, hash);
        }
    });
  });
  const bool comparable = !tiles_.empty() && width == width_ && height == height_;
  std::vector<std::uint8_t> differs(tiles.size(), 1);
  for (std::size_t i = 0; comparable && i < tiles.size(); ++i) differs[i] = tiles[i] != tiles_[i];
  tiles_ = std::move(tiles);
  width_ = width;
  height_ = height;
  return joined(differs, width, height);
}

void cut_to_parts(const ImDrawData& frame, std::span<const Part> parts, ImDrawList& cut) {
  constexpr int kMost = 65535 / 3 * 3;  // vertices that 16 bits can count
  for (const Part& part : parts) {
    each_command(frame, [&](const ImDrawList& list, const ImDrawCmd& command, const Part& room) {
      const Part seen = common(room, part);
      if (seen.empty()) return;
      const auto begin = [&] {
        ImDrawCmd piece;
        piece.ClipRect = ImVec4(static_cast<float>(seen.x0), static_cast<float>(seen.y0),
                                static_cast<float>(seen.x1), static_cast<float>(seen.y1));
        piece.TextureId = command.GetTexID();
        piece.VtxOffset = static_cast<unsigned>(cut.VtxBuffer.Size);
        piece.IdxOffset = static_cast<unsigned>(cut.IdxBuffer.Size);
        cut.CmdBuffer.push_back(piece);
      };
      begin();
      each_triangle(list, command, [&](const Triangle& triangle) {
        if (common(bounds(triangle), seen).empty()) return;
        if (cut.CmdBuffer.back().ElemCount == kMost) begin();
        ImDrawCmd& piece = cut.CmdBuffer.back();
        for (const ImDrawVert& vertex : triangle) {
          cut.VtxBuffer.push_back(vertex);
          cut.IdxBuffer.push_back(static_cast<ImDrawIdx>(piece.ElemCount++));
        }
      });
      if (cut.CmdBuffer.back().ElemCount == 0) cut.CmdBuffer.pop_back();
    });
  }
}

}  // namespace planescope::desktop
