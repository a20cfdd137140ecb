// Draws points on the CPU (gl.hpp).

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "render/gl.hpp"

namespace planescope::render {
namespace {

constexpr int kSamples = 4;
constexpr int kBandRows = 32;  // rows per band, so that their samples stay in the cache
constexpr float kNowhere = std::numeric_limits<float>::infinity();
// Offset of a point's center in Mesa's software renderer with four samples per pixel, which drew
// earlier pictures: new pictures remain comparable.
constexpr float kOffset_px = -0.5f;

struct Splat {
  float x = 0, y = 0;  // [px] from the lower left corner
  float radius_px = 0, radius_m = 0;
  float distance_m = 0;  // of its center along the view
  float rim = 0;         // darkness of the rim; 0 for small splats
  float alpha = 1;       // alpha of its color
  std::uint32_t point = 0;
};

float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// Equivalent of points.vert, without points whose center is outside the picture.
std::vector<Splat> splats_of(const std::vector<DrawPoints>& clouds, const View& view) {
  std::vector<Splat> splats;
  std::uint32_t point = 0;
  for (const DrawPoints& cloud : clouds) {
    const float min_px = std::max(cloud.min_px, 1.0f);
    const float max_px = std::max(cloud.max_px, min_px);
    for (std::size_t i = 0; i < cloud.positions.size(); ++i, ++point) {
      const Eigen::Vector4f eye = view.view * cloud.positions[i].homogeneous();
      const Eigen::Vector4f clip = view.proj * eye;
      if (!(clip.head<3>().cwiseAbs().maxCoeff() <= clip.w())) continue;  // also skips NaN
      const float scale =
          view.orthographic ? view.px_per_m : view.px_per_m / std::max(-eye.z(), 1e-6f);
      Splat splat;
      splat.x = (0.5f * clip.x() / clip.w() + 0.5f) * static_cast<float>(view.width) + kOffset_px;
      splat.y = (0.5f * clip.y() / clip.w() + 0.5f) * static_cast<float>(view.height) + kOffset_px;
      splat.radius_px = 0.5f * std::clamp(cloud.size_m * scale, min_px, max_px);
      splat.radius_m = splat.radius_px / scale;
      splat.distance_m = -eye.z();
      splat.rim = 0.14f * smoothstep(1.5f, 4.0f, splat.radius_px);
      splat.alpha = static_cast<float>(cloud.colors[i].a) / 255;
      splat.point = point;
      splats.push_back(splat);
    }
  }
  return splats;
}

/// Value of a sample, ordered so that the smallest is visible: the distance from the eye (the bits
/// of positive floats are ordered), then the splat drawn last. This makes the result independent of
/// the drawing order.
using Key = std::uint64_t;
constexpr Key kNothing = std::numeric_limits<Key>::max();
Key make_key(float distance_m, std::uint32_t index) {
  return static_cast<Key>(std::bit_cast<std::uint32_t>(distance_m)) << 32 | ~index;
}
float distance_of(Key key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }
std::uint32_t index_of(Key key) { return ~static_cast<std::uint32_t>(key); }

/// A splat that covers a sample also covers the samples before it: the first sample contains the
/// nearest splat, the last the farthest.
using Pixel = std::array<Key, kSamples>;

/// Rows of the picture covered by a splat, from `begin` to before `end`.
std::pair<int, int> rows_of(const Splat& splat, int begin, int end) {
  const float reach = splat.radius_px + 0.5f;
  return {std::max(begin, static_cast<int>(splat.y - reach)),
          std::min(end, static_cast<int>(splat.y + reach) + 1)};
}

/// Equivalent of points.frag for one row: the distance of the splat's surface at each pixel. Soft
/// edges are expressed as the number of covered samples.
void draw_row(const Splat& splat,
              std::uint32_t index,
              int y,
              float near_m,
              std::span<float> distances,
              std::span<Pixel> row) {
  const float dy = static_cast<float>(y) + 0.5f - splat.y;
  const float reach = splat.radius_px + 0.5f;
  const float half = std::sqrt(std::max(reach * reach - dy * dy, 0.0f));
  const int first = std::max(0, static_cast<int>(std::ceil(splat.x - half - 0.5f)));
  const int end = std::min(static_cast<int>(row.size()),
                           static_cast<int>(std::floor(splat.x + half - 0.5f)) + 1);
  const float start = static_cast<float>(first) + 0.5f - splat.x;
  const float per_square = 1 / (splat.radius_px * splat.radius_px);
  float* const distance = distances.data();
  for (int i = 0; i < end - first; ++i) {
    const float dx = start + static_cast<float>(i);
    float r2 = (dx * dx + dy * dy) * per_square;
    r2 = r2 < 1 ? r2 : 1;
    const float to_surface = splat.distance_m - splat.radius_m * (1 - r2);
    distance[i] = to_surface > near_m ? to_surface : near_m;
  }
  for (int i = 0; i < end - first; ++i) {
    const Key key = make_key(distance[i], index);
    Pixel& pixel = row[static_cast<std::size_t>(first + i)];
    if (key > pixel.back()) continue;
    const float dx = start + static_cast<float>(i);
    const float coverage = std::min(reach - std::sqrt(dx * dx + dy * dy), 1.0f) * splat.alpha;
    for (int s = 0; s < kSamples && coverage * kSamples > static_cast<float>(s); ++s)
      pixel[s] = std::min(pixel[s], key);
  }
}

/// 1 inside, less at the rim.
float shade_at(const Splat& splat, int x, int y) {
  if (splat.rim == 0) return 1;
  const float dx = static_cast<float>(x) + 0.5f - splat.x;
  const float dy = static_cast<float>(y) + 0.5f - splat.y;
  const float r = std::min(std::sqrt(dx * dx + dy * dy) / splat.radius_px, 1.0f);
  return 1 - splat.rim * smoothstep(0.55f, 1.0f, r);
}

/// Splats grouped by the bands of rows that they cover, nearest first because they occlude
/// the others.
std::vector<std::vector<std::uint32_t>> by_bands(const std::vector<Splat>& splats, int height) {
  std::vector<std::uint32_t> order(splats.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return splats[i].distance_m; });
  std::vector<std::vector<std::uint32_t>> bands((height + kBandRows - 1) / kBandRows);
  for (const std::uint32_t i : order) {
    const auto [low, high] = rows_of(splats[i], 0, height);
    for (int band = low / kBandRows; band * kBandRows < high; ++band) bands[band].push_back(i);
  }
  return bands;
}

void add_pixel(
    const Pixel& pixel, const std::vector<Splat>& splats, int x, int y, SplatLayer& layer) {
  if (pixel[0] == kNothing) return;
  constexpr float kShare = 1.0f / kSamples;
  const std::size_t at = static_cast<std::size_t>(y) * layer.width + x;
  layer.distances[at] = distance_of(pixel[0]);
  if (pixel.front() == pixel.back()) {
    const Splat& splat = splats[index_of(pixel[0])];
    layer.parts.push_back({splat.point, shade_at(splat, x, y)});
    layer.counts[at] = 1;
    return;
  }
  float share = 0;
  for (int s = 0; s < kSamples; ++s) {
    if (pixel[s] == kNothing) {
      layer.bare[at] += kShare;
      continue;
    }
    if (s == 0 || pixel[s] != pixel[s - 1]) {
      const Splat& splat = splats[index_of(pixel[s])];
      share = kShare * shade_at(splat, x, y);
      layer.parts.push_back({splat.point, 0});
      ++layer.counts[at];
    }
    layer.parts.back().share += share;
  }
}

/// Equivalent of shade.frag: eye-dome lighting.
std::vector<float> lights(const SplatLayer& layer, const View& view) {
  const float radius_px = shade_radius_px(view);
  const int straight = static_cast<int>(std::lround(radius_px));
  const int slanted = static_cast<int>(std::lround(0.7071f * radius_px));
  const int ring[8][2] = {{straight, 0},       {slanted, slanted}, {0, straight},
                          {-slanted, slanted}, {-straight, 0},     {-slanted, -slanted},
                          {0, -straight},      {slanted, -slanted}};
  // With a margin that repeats the outermost pixels; empty pixels are infinitely far.
  const int width = layer.width, height = layer.height;
  const std::size_t stride = static_cast<std::size_t>(width) + 2 * straight;
  std::vector<float> logs(stride * (height + 2 * straight));
  for (int y = 0; y < height; ++y) {
    float* row = &logs[stride * (y + straight)];
    const float* distance = &layer.distances[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < width; ++x)
      row[straight + x] = distance[x] < kNowhere ? std::log2(distance[x]) : kNowhere;
    std::fill_n(row, straight, row[straight]);
    std::fill_n(row + straight + width, straight, row[straight + width - 1]);
  }
  for (int y = 0; y < straight; ++y) {
    std::copy_n(&logs[stride * straight], stride, &logs[stride * y]);
    std::copy_n(&logs[stride * (height + straight - 1)], stride,
                &logs[stride * (height + straight + y)]);
  }
  std::vector<float> result(layer.distances.size(), 1.0f);
  std::vector<float> before(width);
  for (int y = 0; y < height; ++y) {
    const float* here = &logs[stride * (y + straight) + straight];
    const auto is_point = [](float log) { return log < kNowhere; };
    const auto begin = static_cast<int>(std::find_if(here, here + width, is_point) - here);
    int end = width;
    while (end > begin && !is_point(here[end - 1])) --end;
    std::ranges::fill(before, 0.0f);
    for (const auto& [dx, dy] : ring) {
      const float* there = here + dy * static_cast<std::ptrdiff_t>(stride) + dx;
      for (int x = begin; x < end; ++x) {
        float step = here[x] - there[x];
        step = step > 0.0f ? step : 0.0f;
        before[x] += step < 0.015f ? step : 0.015f;
      }
    }
    float* light = &result[static_cast<std::size_t>(y) * width];
    for (int x = begin; x < end; ++x)
      if (before[x] > 0 && here[x] < kNowhere)
        light[x] = std::max(std::exp(-60.0f * before[x] / 8), 0.3f);
  }
  return result;
}

}  // namespace

float shade_radius_px(const View& view) {
  return static_cast<float>(std::max(1.0, 2 * overlay_scale(view)));
}

SplatLayer splat(const std::vector<DrawPoints>& clouds, const View& view) {
  SplatLayer layer;
  layer.width = view.width;
  layer.height = view.height;
  const std::size_t pixels = static_cast<std::size_t>(view.width) * view.height;
  layer.distances.assign(pixels, kNowhere);
  layer.counts.assign(pixels, 0);
  layer.bare.assign(pixels, 0);
  layer.parts.reserve(pixels);
  const std::vector<Splat> splats = splats_of(clouds, view);
  const auto bands = by_bands(splats, view.height);
  std::vector<float> distances(view.width);
  std::vector<Pixel> samples(static_cast<std::size_t>(view.width) * kBandRows);
  for (int begin = 0; begin < view.height; begin += kBandRows) {
    Pixel nothing;
    nothing.fill(kNothing);
    std::ranges::fill(samples, nothing);
    const int end = std::min(begin + kBandRows, view.height);
    const auto row = [&](int y) {
      return std::span(samples).subspan(static_cast<std::size_t>(y - begin) * view.width,
                                        view.width);
    };
    for (const std::uint32_t i : bands[begin / kBandRows]) {
      const auto [low, high] = rows_of(splats[i], begin, end);
      for (int y = low; y < high; ++y) draw_row(splats[i], i, y, view.near_m, distances, row(y));
    }
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < view.width; ++x) add_pixel(row(y)[x], splats, x, y, layer);
  }
  layer.light = lights(layer, view);
  return layer;
}

Image8 paint(const SplatLayer& layer,
             const std::vector<DrawPoints>& clouds,
             const ThemeColors& theme) {
  using Color = Eigen::Array4f;
  const auto to_color = [](Rgba c) { return Color(c.r, c.g, c.b, 0); };
  std::vector<Color> colors;
  for (const DrawPoints& cloud : clouds)
    for (const Rgba color : cloud.colors) colors.push_back(to_color(color));
  const Color top = to_color(theme.background_top), bottom = to_color(theme.background_bottom);
  Image8 image(layer.width, layer.height, 4);
  const auto to_bytes = [](const Color& color, std::uint8_t* out) {
    const Eigen::Array4i rounded = (color + 0.5f).cast<int>();
    for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(rounded[c]);
    out[3] = 255;
  };
  const SplatLayer::Part* part = layer.parts.data();
  std::size_t i = 0;
  for (int y = 0; y < layer.height; ++y) {
    const float up = (static_cast<float>(y) + 0.5f) / static_cast<float>(layer.height);
    const Color background = bottom + (top - bottom) * up;
    std::array<std::uint8_t, 4> empty{};
    to_bytes(background, empty.data());
    std::uint8_t* out = &image.at(0, y);
    for (int x = 0; x < layer.width; ++x, ++i, out += 4) {
      if (layer.counts[i] == 0) {
        std::ranges::copy(empty, out);
        continue;
      }
      Color sum = layer.bare[i] * background;
      for (int k = 0; k < layer.counts[i]; ++k, ++part) sum += part->share * colors[part->point];
      to_bytes(layer.light[i] * sum, out);
    }
  }
  return image;
}

std::vector<std::uint32_t> depths(const SplatLayer& layer, const View& view) {
  const double scale = view.proj(2, 2), offset = view.proj(2, 3);
  std::vector<std::uint32_t> result;
  result.reserve(layer.distances.size());
  for (const float distance : layer.distances) {
    double ndc = 1;
    if (distance < kNowhere) ndc = (offset - scale * distance) / (view.orthographic ? 1 : distance);
    result.push_back(static_cast<std::uint32_t>(std::clamp(0.5 * ndc + 0.5, 0.0, 1.0) *
                                                std::numeric_limits<std::uint32_t>::max()));
  }
  return result;
}

bool same_shapes(const std::vector<DrawPoints>& a, const std::vector<DrawPoints>& b) {
  const auto same_alpha = [](Rgba x, Rgba y) { return x.a == y.a; };
  return std::ranges::equal(a, b, [&](const DrawPoints& x, const DrawPoints& y) {
    return x.size_m == y.size_m && x.min_px == y.min_px && x.max_px == y.max_px &&
           x.positions == y.positions && std::ranges::equal(x.colors, y.colors, same_alpha);
  });
}

}  // namespace planescope::render
