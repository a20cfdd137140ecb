#pragma once

// Draws what overlay.hpp lays out, in pixels from the top left corner of the picture.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "render/font.hpp"
#include "render/gl.hpp"
#include "render/overlay.hpp"

namespace planescope::render {

class ShapePass {
 public:
  ShapePass();
  void draw(std::span<const OverlayShape> shapes, int width, int height);

 private:
  GlProgram program_;
  GlVertexArray array_;
  GlBuffer instances_;
};

/// Text from an atlas that gathers the glyphs as they are met.
class TextPass {
 public:
  TextPass();
  void draw(std::span<const OverlayText> texts, int width, int height);

 private:
  struct Key {
    char32_t codepoint = 0;
    int size_q = 0;  // 1/16 px
    int phase = 0;
    int halo_q = 0;  // 1/16 px
    auto operator<=>(const Key&) const = default;
  };
  struct Entry {
    int x = 0, y = 0;  // in the atlas
    int width = 0, height = 0;
    int left = 0, top = 0;
  };
  struct Instance {
    float x = 0, y = 0, width = 0, height = 0;
    float atlas_x = 0, atlas_y = 0;
    Rgba color;
  };

  bool append(const OverlayText& text, std::vector<Instance>& instances);
  const Entry* entry(const Key& key);
  void clear_atlas(int height);
  void upload_atlas();

  static constexpr int kAtlasWidth = 1024;
  int atlas_height_ = 0;
  std::vector<std::uint8_t> atlas_;
  bool atlas_changed_ = false;
  int shelf_x_ = 0, shelf_y_ = 0, shelf_height_ = 0;
  std::map<Key, Entry> entries_;

  GlProgram program_;
  GlVertexArray array_;
  GlBuffer instances_;
  GlTexture texture_;
};

}  // namespace planescope::render
