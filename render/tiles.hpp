#pragma once

// Which parts of a picture change, from hashes of what is drawn into its tiles: a step of the
// window changes few of them. Scenes drawn as a whole: a step takes 1.24 times as long (llvmpipe,
// two cores, 1440 x 900, `planescope-lab bench desktop`).

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace planescope::render {

struct DrawList;
struct Overlay;
struct View;

/// Pixels from the top left; the second corner is outside.
struct Part {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::int64_t pixels() const { return empty() ? 0 : std::int64_t{x1 - x0} * (y1 - y0); }
  bool operator==(const Part&) const = default;
};

/// A coordinate in pixels, limited far beyond any picture; 0 of NaN.
int whole_px(double place);
Part common(const Part& a, const Part& b);
/// The smallest that holds both.
Part around(const Part& a, const Part& b);
/// At most that many parts that hold all of them; they may overlap.
std::vector<Part> at_most(std::vector<Part> parts, std::size_t count);
/// Parts that hold all of them, with more than that many pixels between any two.
std::vector<Part> apart(std::vector<Part> parts, int reach_px);

class Tiles {
 public:
  Tiles() = default;
  Tiles(int width, int height);

  /// Something of that hash is drawn next, and touches no pixel outside.
  void add(const Part& touched, std::uint64_t hash);
  /// Where the picture may differ from the one before: parts that do not overlap. All of it where
  /// that was of another size.
  std::vector<Part> changes_since(const Tiles& before) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::uint64_t> hashes_;  // row by row
};

/// Of values without padding, in words of 32 bits.
template <typename... Values>
std::uint64_t hashed(std::uint64_t hash, const Values&... values) {
  const auto add = [&](const auto& value) {
    static_assert(sizeof(value) % 4 == 0);
    std::array<std::uint32_t, sizeof(value) / 4> words;
    std::memcpy(words.data(), &value, sizeof(value));
    for (const std::uint32_t word : words) {
      hash = (hash ^ word) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 29;
    }
  };
  (add(values), ...);
  return hash;
}

/// What a list draws where, seen from one place. Pictures from another place or in another theme
/// are not compared.
Tiles scene_tiles(const DrawList& list,
                  const Overlay& overlay,
                  const View& view,
                  float shade_radius_px);

}  // namespace planescope::render
