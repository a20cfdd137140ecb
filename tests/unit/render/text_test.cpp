#include <algorithm>

#include "gl_fixture.hpp"
#include "render/font.hpp"
#include "render/paint.hpp"

namespace planescope::render {
namespace {

// Columns that hold any ink: first and last, or -1 where there is none.
std::pair<int, int> ink_columns(const Image8& image) {
  int first = -1;
  int last = -1;
  for (int x = 0; x < image.width; ++x) {
    for (int y = 0; y < image.height; ++y) {
      if (image.at(x, y) > 64) {
        last = x;
        if (first < 0) first = x;
      }
    }
  }
  return {first, last};
}

TEST(Text, InkCoversTheWidthThatIsReported) {
  Image8 image(400, 60, 3);
  const double advance = draw_text(image, 20, 40, "MnHoM", 24, {255, 255, 255});
  EXPECT_DOUBLE_EQ(advance, text_width("MnHoM", 24));
  const auto [first, last] = ink_columns(image);
  EXPECT_NEAR(first, 20, 4);
  EXPECT_NEAR(last, 20 + advance, 4);
}

TEST(Text, StandsOnItsBaseline) {
  Image8 image(60, 60, 3);
  draw_text(image, 5, 40, "H", 30, {255, 255, 255});
  EXPECT_GT(image.at(10, 38), 100);  // the left stem of the H
  EXPECT_GT(image.at(10, 21), 100);
  for (int x = 0; x < 60; ++x) EXPECT_EQ(image.at(x, 41), 0);
}

TEST(Text, WidthGrowsWithTheSize) {
  EXPECT_NEAR(text_width("planes", 28), 2 * text_width("planes", 14), 1e-3);
  EXPECT_EQ(text_width("", 14), 0);
}

TEST(Text, HasEveryCharacterOfOurPictures) {
  const std::string text = "θστα µμ ≤≥±°×²³·–—…√Δλ 0123456789 (h/v) äöüß";
  for (const char32_t c : decode_utf8(text)) {
    EXPECT_TRUE(default_font().has_glyph(c)) << static_cast<unsigned>(c);
  }
}

TEST(Text, BrokenUtf8BecomesReplacementCharacters) {
  EXPECT_EQ(decode_utf8("a\xC3\xA4z").size(), 3u);
  EXPECT_EQ(decode_utf8("a\xC3\xA4z")[1], U'ä');
  EXPECT_EQ(decode_utf8("\xF0\x9F\x98\x80")[0], char32_t{0x1F600});
  EXPECT_EQ(decode_utf8("\xFFz")[0], char32_t{0xFFFD});
  EXPECT_EQ(decode_utf8("z\xE2\x89").size(), 3u);  // cut short: one per byte
}

TEST(Text, IsClippedAtTheImagesEdges) {
  Image8 image(20, 10, 3);
  EXPECT_NO_THROW(draw_text(image, -30, 5, "planescope", 40, {255, 255, 255}));
  EXPECT_NO_THROW(draw_text(image, 15, -100, "planescope", 40, {255, 255, 255}));
  EXPECT_NO_THROW(draw_text(image, 15, 500, "planescope", 40, {255, 255, 255}));
}

TEST(Text, AlphaBlendsWithTheImage) {
  Image8 full(60, 60, 3);
  Image8 half(60, 60, 3);
  draw_text(full, 5, 50, "H", 50, {255, 255, 255});
  draw_text(half, 5, 50, "H", 50, {255, 255, 255, 128});
  EXPECT_EQ(*std::max_element(full.data.begin(), full.data.end()), 255);
  EXPECT_NEAR(*std::max_element(half.data.begin(), half.data.end()), 128, 1);
}

TEST(Text, HaloSurroundsTheGlyph) {
  const GlyphBitmap glyph = default_font().glyph(U'l', 20, 0);
  const GlyphBitmap halo = grown(glyph, 2);
  EXPECT_GT(halo.width, glyph.width + 3);
  EXPECT_EQ(halo.left + halo.width - glyph.left - glyph.width, glyph.left - halo.left);
  for (int y = 0; y < glyph.height; ++y) {
    for (int x = 0; x < glyph.width; ++x) {
      const int hx = x + glyph.left - halo.left;
      const int hy = y + glyph.top - halo.top;
      EXPECT_GE(halo.coverage[hy * halo.width + hx], glyph.coverage[y * glyph.width + x]);
    }
  }
}

struct OverlayPicture : GlTest {};

TEST_F(OverlayPicture, ManySizesOfTextOutgrowTheAtlasAndAreAllDrawn) {
  DrawList list = without_overlay();
  for (int i = 0; i < 60; ++i) {
    const auto y = static_cast<float>(i % 10) * 0.08f - 0.4f;
    list.labels.push_back({{0, y, 0}, "ABCDEFGHIJ", {255, 0, 0}, 40 + static_cast<float>(i), true});
  }
  const Image8 first = render(list, front_camera());
  EXPECT_EQ(render(list, front_camera()).data, first.data);
  int red = 0;
  for (int x = 0; x < kWidth; ++x) red += pixel(first, x, kHeight / 2).g < 60;
  EXPECT_GT(red, 20);
}

TEST(FontFile, IsATrueTypeFile) {
  ASSERT_GT(font_file().size(), 100'000u);
  EXPECT_EQ(font_file().substr(0, 4), std::string_view("\0\1\0\0", 4));
}

}  // namespace
}  // namespace planescope::render
