#include "render/overlay_passes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/model/error.hpp"

PLANESCOPE_ASSET_DECLARE(glyphs_frag);
PLANESCOPE_ASSET_DECLARE(glyphs_vert);
PLANESCOPE_ASSET_DECLARE(shapes_frag);
PLANESCOPE_ASSET_DECLARE(shapes_vert);

namespace planescope::render {

// ---- Shapes ----

ShapePass::ShapePass()
    : program_(
          make_program("shapes", PLANESCOPE_ASSET(shapes_vert), PLANESCOPE_ASSET(shapes_frag))),
      array_(make_vertex_array()),
      instances_(make_buffer()) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  const std::size_t stride = sizeof(OverlayShape);
  static_assert(offsetof(OverlayShape, hatch_period_px) == offsetof(OverlayShape, radius) + 8);
  set_attribute({0, 4, GL_FLOAT, stride, offsetof(OverlayShape, x0), true});
  set_attribute({1, 4, GL_UNSIGNED_BYTE, stride, offsetof(OverlayShape, fill), true});
  set_attribute({2, 4, GL_UNSIGNED_BYTE, stride, offsetof(OverlayShape, border), true});
  set_attribute({3, 3, GL_FLOAT, stride, offsetof(OverlayShape, radius), true});
}

void ShapePass::draw(std::span<const OverlayShape> shapes, int width, int height) {
  if (shapes.empty()) return;
  glUseProgram(program_);
  set_uniform(program_, "viewport",
              Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height)));
  glBindVertexArray(array_);
  upload(instances_, shapes);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(shapes.size()));
}

// ---- Text ----

namespace {

constexpr double kMaxSize_px = 256;

int sixteenths(double value) { return static_cast<int>(std::lround(value * 16)); }

}  // namespace

TextPass::TextPass()
    : program_(
          make_program("glyphs", PLANESCOPE_ASSET(glyphs_vert), PLANESCOPE_ASSET(glyphs_frag))),
      array_(make_vertex_array()),
      instances_(make_buffer()),
      texture_(make_texture()) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances_);
  const std::size_t stride = sizeof(Instance);
  set_attribute({0, 4, GL_FLOAT, stride, offsetof(Instance, x), true});
  set_attribute({1, 2, GL_FLOAT, stride, offsetof(Instance, atlas_x), true});
  set_attribute({2, 4, GL_UNSIGNED_BYTE, stride, offsetof(Instance, color), true});
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  clear_atlas(512);
}

void TextPass::draw(std::span<const OverlayText> texts, int width, int height) {
  // Where the atlas is full, start over with an empty one; where that is not enough for these
  // texts alone, with a larger one.
  std::vector<Instance> instances;
  for (int attempt = 0;; ++attempt) {
    instances.clear();
    const auto fits = [&](const OverlayText& text) { return append(text, instances); };
    if (std::all_of(texts.begin(), texts.end(), fits)) break;
    clear_atlas(attempt == 0 ? atlas_height_ : atlas_height_ * 2);
  }
  if (instances.empty()) return;
  glUseProgram(program_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  if (atlas_changed_) upload_atlas();
  set_uniform(program_, "atlas", 0);
  set_uniform(program_, "viewport",
              Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height)));
  glBindVertexArray(array_);
  upload(instances_, instances);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(instances.size()));
}

// False where the atlas is full.
bool TextPass::append(const OverlayText& text, std::vector<Instance>& instances) {
  const double size_px = std::clamp(text.size_px, 1.0, kMaxSize_px);
  const TextLayout layout = default_font().layout(text.text, size_px);
  const double baseline = std::round(text.baseline);
  for (const bool halo : {true, false}) {
    if (halo && (text.halo_px <= 0 || text.halo.a == 0)) continue;
    for (const PlacedGlyph& placed : layout.glyphs) {
      const Font::Pen pen = Font::pen_at(text.x + placed.x);
      const Entry* glyph = entry(
          {placed.codepoint, sixteenths(size_px), pen.phase, halo ? sixteenths(text.halo_px) : 0});
      if (glyph == nullptr) return false;
      if (glyph->width == 0) continue;
      instances.push_back({static_cast<float>(pen.column + glyph->left),
                           static_cast<float>(baseline + glyph->top),
                           static_cast<float>(glyph->width), static_cast<float>(glyph->height),
                           static_cast<float>(glyph->x), static_cast<float>(glyph->y),
                           halo ? text.halo : text.color});
    }
  }
  return true;
}

const TextPass::Entry* TextPass::entry(const Key& key) {
  if (const auto found = entries_.find(key); found != entries_.end()) return &found->second;
  GlyphBitmap glyph = default_font().glyph(key.codepoint, key.size_q / 16.0, key.phase);
  if (key.halo_q > 0 && glyph.width > 0) glyph = grown(glyph, key.halo_q / 16.0);
  if (shelf_x_ + glyph.width > kAtlasWidth) {
    shelf_y_ += shelf_height_ + 1;
    shelf_x_ = 0;
    shelf_height_ = 0;
  }
  if (glyph.width > kAtlasWidth || shelf_y_ + glyph.height > atlas_height_) return nullptr;
  for (int y = 0; y < glyph.height; ++y) {
    std::memcpy(atlas_.data() + static_cast<std::size_t>(shelf_y_ + y) * kAtlasWidth + shelf_x_,
                glyph.coverage.data() + static_cast<std::size_t>(y) * glyph.width,
                static_cast<std::size_t>(glyph.width));
  }
  atlas_changed_ = true;
  const Entry entry = {shelf_x_, shelf_y_, glyph.width, glyph.height, glyph.left, glyph.top};
  shelf_x_ += glyph.width + 1;
  shelf_height_ = std::max(shelf_height_, glyph.height);
  return &entries_.emplace(key, entry).first->second;
}

void TextPass::clear_atlas(int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (height > largest)
    throw Error("the picture has more different glyphs than a texture can hold");
  atlas_height_ = height;
  atlas_.assign(static_cast<std::size_t>(kAtlasWidth) * height, 0);
  entries_.clear();
  shelf_x_ = shelf_y_ = shelf_height_ = 0;
  atlas_changed_ = true;
}

void TextPass::upload_atlas() {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, kAtlasWidth, atlas_height_, 0, GL_RED, GL_UNSIGNED_BYTE,
               atlas_.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  atlas_changed_ = false;
}

}  // namespace planescope::render
