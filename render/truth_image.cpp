#include "render/truth_image.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "render/paint.hpp"
#include "render/plane_colors.hpp"
#include "render/region_image.hpp"
#include "render/scene_parts.hpp"

namespace planescope::render {
namespace {

constexpr double kTruthTint = 0.55;
constexpr Rgba kTruthInk{32, 36, 42, 255};
constexpr int kTitleRoom = 52, kLegendRoom = 52, kGap = 12;  // [px]
constexpr const char* kTitles[] = {"Labels", "Found", "Errors"};
constexpr std::size_t kVerdicts = 6;
constexpr std::array<const char*, kVerdicts> kNames = {"not scored", "right",       "missed",
                                                       "invented",   "wrong plane", "wrong class"};

std::array<std::size_t, kVerdicts> counts_of(const planes::JudgedFrame& judged) {
  std::array<std::size_t, kVerdicts> counts{};
  for (const planes::Verdict verdict : judged.verdict) ++counts[static_cast<std::size_t>(verdict)];
  return counts;
}

/// Colour of a kind of error; faded for points that are right or were not scored.
Rgba verdict_color(planes::Verdict verdict) {
  switch (verdict) {
    case planes::Verdict::missed:
      return {0, 114, 178, 255};
    case planes::Verdict::invented:
      return {230, 159, 0, 255};
    case planes::Verdict::wrong_plane:
      return {204, 60, 130, 255};
    case planes::Verdict::wrong_class:
      return {0, 158, 115, 255};
    case planes::Verdict::unscored:
    case planes::Verdict::right:
      break;
  }
  return kSceneFaded;
}

/// What each of the three pictures shows of a point; alpha 0: nothing.
struct PointColors {
  std::vector<Rgba> of[3];
};
PointColors point_colors(const planes::FrameResult& result,
                         const planes::JudgedFrame& judged,
                         std::span<const int> color_of_plane) {
  constexpr Rgba kNone{0, 0, 0, 0};
  const std::vector<int> true_colors =
      true_plane_colors(plane_image(result.cloud, judged.true_plane, judged.found_of.size()),
                        judged.found_of, color_of_plane);
  PointColors colors;
  for (std::size_t i = 0; i < judged.verdict.size(); ++i) {
    const std::int32_t truth = judged.true_plane[i], found = result.plane_of[i];
    colors.of[0].push_back(truth > 0 ? color_of(truth, true_colors) : kNone);
    colors.of[1].push_back(found > 0 ? color_of(found, color_of_plane) : kNone);
    const planes::Verdict verdict = judged.verdict[i];
    colors.of[2].push_back(verdict == planes::Verdict::right ? kNone : verdict_color(verdict));
  }
  return colors;
}

Image8 titled(const Image8& image, const std::string& title) {
  Image8 result(image.width, image.height + kTitleRoom, 3, 255);
  draw_text(result, 4, kTitleRoom - 16, title, 30, kTruthInk);
  std::copy(image.data.begin(), image.data.end(),
            result.data.begin() + static_cast<std::ptrdiff_t>(3) * image.width * kTitleRoom);
  return result;
}

Image8 with_legend(const Image8& image, const planes::JudgedFrame& judged) {
  Image8 result(image.width, image.height + kLegendRoom, 3, 255);
  std::copy(image.data.begin(), image.data.end(), result.data.begin());
  const int y = image.height + 12;
  double x = 4;
  const auto counts = counts_of(judged);
  for (std::size_t k = 2; k < kVerdicts; ++k) {
    fill_rect(result, static_cast<int>(x), y, 26, 26,
              verdict_color(static_cast<planes::Verdict>(k)));
    x += 36;
    x += draw_text(result, x, y + 22, fmt::format("{} {}", kNames[k], counts[k]), 26, kTruthInk) +
         36;
  }
  return result;
}

}  // namespace

std::string errors_text(const planes::JudgedFrame& judged) {
  const auto counts = counts_of(judged);
  const std::size_t scored = judged.verdict.size() - counts[0];
  std::string text;
  for (std::size_t k = 2; k < kVerdicts; ++k)
    if (counts[k] > 0)
      text +=
          fmt::format("{}{} {}", text.empty() ? "" : ", ", kNames[k], percent(counts[k], scored));
  return text.empty() ? "all right" : text;
}

Image8 image_truth(const Frame& frame,
                   const planes::FrameResult& result,
                   const planes::JudgedFrame& judged,
                   std::span<const int> color_of_plane) {
  const PointColors colors = point_colors(result, judged, color_of_plane);
  const Image8 relief = shaded_depth(frame);
  const int factor = enlargement(relief.width);
  std::vector<Image8> panels;
  for (int k = 0; k < 3; ++k) {
    Image8 panel = relief;
    for (std::size_t i = 0; i < result.cloud.source.size(); ++i) {
      const auto pixel = static_cast<int>(result.cloud.source[i]);
      const Rgba color = colors.of[k][i];
      if (color.a > 0)
        blend_pixel(panel, pixel % panel.width, pixel / panel.width, color,
                    k < 2 ? kTruthTint : 0.85);
    }
    panels.push_back(titled(enlarge(panel, factor), kTitles[k]));
  }
  return with_legend(side_by_side(panels), judged);
}

std::array<DrawList, 3> scenes_truth(const planes::FrameResult& result,
                                     const planes::JudgedFrame& judged,
                                     std::span<const int> color_of_plane) {
  const PointColors colors = point_colors(result, judged, color_of_plane);
  std::array<DrawList, 3> scenes;
  for (int k = 0; k < 3; ++k) {
    std::vector<std::size_t> at;
    DrawPoints points = kept_points(result.cloud, at);
    for (const std::size_t i : at)
      points.colors.push_back(colors.of[k][i].a > 0 ? colors.of[k][i] : kSceneFaded);
    scenes[k].points.push_back(std::move(points));
    scenes[k].title = kTitles[k];
  }
  const auto counts = counts_of(judged);
  for (std::size_t v = 2; v < kVerdicts; ++v)
    scenes[2].legend.push_back({LegendEntry::Mark::dot,
                                verdict_color(static_cast<planes::Verdict>(v)),
                                fmt::format("{}  {}", kNames[v], counts[v])});
  return scenes;
}

Image8 side_by_side(std::span<const Image8> images) {
  int width = -kGap, height = 0;
  for (const Image8& image : images) {
    width += image.width + kGap;
    height = std::max(height, image.height);
  }
  Image8 row(std::max(width, 0), height, 3, 255);
  int left = 0;
  for (const Image8& image : images) {
    for (int y = 0; y < image.height; ++y)
      std::copy_n(&image.at(0, y), 3 * image.width, &row.at(left, y));
    left += image.width + kGap;
  }
  return row;
}

}  // namespace planescope::render
