// Tests of color contrast, for normal and color-blind vision, and of color scales.

#include "render/palette.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "render/step_scene.hpp"

namespace planescope::render {
namespace {

using Linear = std::array<double, 3>;

double linear(std::uint8_t value) {
  const double c = value / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// Machado, Oliveira & Fernandes 2009, severity 1.
enum class Eye { normal, protanopia, deuteranopia, tritanopia };
Linear seen(Rgba color, Eye eye) {
  static const double kProtanopia[3][3] = {{0.152286, 1.052583, -0.204868},
                                           {0.114503, 0.786281, 0.099216},
                                           {-0.003882, -0.048116, 1.051998}};
  static const double kDeuteranopia[3][3] = {{0.367322, 0.860646, -0.227968},
                                             {0.280085, 0.672501, 0.047413},
                                             {-0.011820, 0.042940, 0.968881}};
  static const double kTritanopia[3][3] = {{1.255528, -0.076749, -0.178779},
                                           {-0.078411, 0.930809, 0.147602},
                                           {0.004733, 0.691367, 0.303900}};
  const Linear in = {linear(color.r), linear(color.g), linear(color.b)};
  if (eye == Eye::normal) return in;
  const auto& m = eye == Eye::protanopia     ? kProtanopia
                  : eye == Eye::deuteranopia ? kDeuteranopia
                                             : kTritanopia;
  Linear out{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i] += m[i][j] * in[j];
    out[i] = std::clamp(out[i], 0.0, 1.0);
  }
  return out;
}

Linear oklab(const Linear& c) {
  const double l = std::cbrt(0.4122214708 * c[0] + 0.5363325363 * c[1] + 0.0514459929 * c[2]);
  const double m = std::cbrt(0.2119034982 * c[0] + 0.6806995451 * c[1] + 0.1073969566 * c[2]);
  const double s = std::cbrt(0.0883024619 * c[0] + 0.2817188376 * c[1] + 0.6299787005 * c[2]);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

/// Distance in OKLab, times 100: about 2 is barely noticeable side by side, 10 is hard to confuse.
double distance(Rgba a, Rgba b, Eye eye) {
  const Linear x = oklab(seen(a, eye));
  const Linear y = oklab(seen(b, eye));
  return 100 * std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

double worst_distance(Rgba a, Rgba b) {
  return std::min({distance(a, b, Eye::normal), distance(a, b, Eye::protanopia),
                   distance(a, b, Eye::deuteranopia), distance(a, b, Eye::tritanopia)});
}

double contrast(Rgba a, Rgba b) {
  const auto luminance = [](Rgba c) {
    return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b) + 0.05;
  };
  return std::max(luminance(a), luminance(b)) / std::min(luminance(a), luminance(b));
}

constexpr Rgba kLightBackground = {243, 245, 247};
constexpr Rgba kDarkBackground = {23, 26, 30};

void expect_apart(const std::vector<Rgba>& colors) {
  for (std::size_t a = 0; a < colors.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GT(worst_distance(colors[a], colors[b]), 11) << a << " " << b;
}

TEST(Palette, CasesDifferFromEachOtherAndFromUnassignedPoints) {
  expect_apart({case_color(planes::Case::I), case_color(planes::Case::II),
                case_color(planes::Case::III), case_color(planes::Case::IV), leftover_color()});
}

TEST(Palette, SteppablePlanesDifferFromOthersAndFromUnassignedPoints) {
  expect_apart({verdict_color(true), verdict_color(false), leftover_color()});
}

TEST(Palette, LabelsDifferForColorBlindVision) {
  EXPECT_GT(worst_distance(label_color(Label::h), label_color(Label::v)), 20);
  EXPECT_GT(worst_distance(label_color(Label::h), label_color(Label::unknown)), 11);
  EXPECT_GT(worst_distance(label_color(Label::v), label_color(Label::unknown)), 11);
}

TEST(Palette, MarginsGetLighterAndMoreSaturatedUpToTheLabelsColor) {
  for (const Label label : {Label::h, Label::v}) {
    double lightness_before = 0, chroma_before = 0;
    for (int i = 0; i <= 20; ++i) {
      const Linear c = oklab(seen(margin_color(label, i / 20.0), Eye::normal));
      const double chroma = std::hypot(c[1], c[2]);
      EXPECT_GT(c[0], lightness_before) << i;
      EXPECT_GT(chroma, chroma_before) << i;
      lightness_before = c[0];
      chroma_before = chroma;
    }
    EXPECT_EQ(margin_color(label, 1), label_color(label));
  }
  EXPECT_EQ(margin_color(Label::h, 0), margin_color(Label::v, 0));
  EXPECT_EQ(margin_color(Label::unknown, 0.5), label_color(Label::unknown));
  EXPECT_GT(worst_distance(margin_color(Label::h, 0.5), margin_color(Label::v, 0.5)), 11);
}

TEST(Palette, CasesAndLabelsAreVisibleOnBothThemes) {
  std::vector<Rgba> colors = {leftover_color(), label_color(Label::h), label_color(Label::v)};
  for (const planes::Case c :
       {planes::Case::I, planes::Case::II, planes::Case::III, planes::Case::IV})
    colors.push_back(case_color(c));
  for (const Rgba color : colors) {
    EXPECT_GT(contrast(color, kLightBackground), 1.9);
    EXPECT_GT(contrast(color, kDarkBackground), 2.9);
  }
}

// Any two planes may touch. The palette's smallest distances are 12.5 for normal vision and 9.1 for
// color-blind vision; to the gray of points without a plane 12.0 and 10.0.
constexpr double kLeastApart = 12, kLeastApartColorBlind = 9;

TEST(Palette, AnyTwoPlanesDifferForAllVision) {
  for (int a = 1; a <= kPlaneColors; ++a) {
    const Rgba color = plane_color(a);
    for (int b = 1; b < a; ++b) {
      EXPECT_GT(distance(color, plane_color(b), Eye::normal), kLeastApart) << a << " " << b;
      for (const Eye eye : {Eye::protanopia, Eye::deuteranopia, Eye::tritanopia})
        EXPECT_GT(distance(color, plane_color(b), eye), kLeastApartColorBlind) << a << " " << b;
    }
    for (const Eye eye : {Eye::normal, Eye::protanopia, Eye::deuteranopia, Eye::tritanopia})
      EXPECT_GT(distance(color, leftover_color(), eye), kLeastApartColorBlind) << a;
    EXPECT_GT(contrast(color, kLightBackground), 1.4) << a;
    EXPECT_GT(contrast(color, kDarkBackground), 2.3) << a;
    for (const Theme theme : {Theme::light, Theme::dark}) {
      EXPECT_GT(distance(color, highlight_colors(theme).selected, Eye::normal), kLeastApart) << a;
      EXPECT_GT(distance(color, highlight_colors(theme).marked, Eye::normal), kLeastApart) << a;
    }
  }
  EXPECT_EQ(plane_color(1), plane_color(kPlaneColors + 1));
}

TEST(Palette, TheRampGetsEvenlyLighterAndStaysWithinItsEnds) {
  double before = 100 * oklab(seen(ramp_color(0), Eye::normal))[0];
  for (int i = 1; i <= 30; ++i) {
    const double lightness = 100 * oklab(seen(ramp_color(i / 30.0), Eye::normal))[0];
    EXPECT_GT(lightness, before);
    EXPECT_LT(lightness - before, 5);
    before = lightness;
  }
  EXPECT_EQ(ramp_color(2), ramp_color(1));
  EXPECT_EQ(ramp_color(-1), ramp_color(0));
}

TEST(ColorScale, TicksAreRoundInOneUnitAndWithinTheRange) {
  const auto texts = [](double low, double high, ColorScale::Map map = ColorScale::Map::rising) {
    std::string all;
    const ScaleTicks ticks = ticks_of({.what = "", .range = {low, high}, .map = map});
    for (const ScaleTick& tick : ticks.ticks) {
      EXPECT_GE(tick.value_m, low - 1e-9);
      EXPECT_LE(tick.value_m, high + 1e-9);
      all += tick.text + " ";
    }
    return all + ticks.unit;
  };
  EXPECT_EQ(texts(0.7, 1.5), "0.8 1.0 1.2 1.4 m");
  EXPECT_EQ(texts(0, 0.02), "0 5 10 15 20 mm");
  EXPECT_EQ(texts(-0.01, 0.01, ColorScale::Map::diverging), "-10 -5 0 +5 +10 mm");
  EXPECT_EQ(texts(0, 0.5), "0 10 20 30 40 50 cm");
  EXPECT_EQ(texts(0, 200), "0 50 100 150 200 m");
}

TEST(ColorScale, ColorsBeyondTheEndsAreThoseOfTheEnds) {
  ColorScale scale{.what = "", .range = {1, 3}};
  EXPECT_EQ(scale.color(9), ramp_color(1));
  EXPECT_EQ(scale.color(-9), ramp_color(0));
  scale.map = ColorScale::Map::falling;
  EXPECT_EQ(scale.color(1), ramp_color(1));
  scale.map = ColorScale::Map::diverging;
  EXPECT_GT(scale.color(1).b, scale.color(1).r);
  EXPECT_GT(scale.color(3).r, scale.color(3).b);
}

}  // namespace
}  // namespace planescope::render
