#pragma once

// Small marks painted into an RGB image on the CPU.

#include "core/model/image.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

/// Color over the pixel, with `color.a` and `coverage` (0..1) as weights. Outside: nothing.
void blend_pixel(Image8& image, int x, int y, Rgba color, double coverage = 1);
void fill_rect(Image8& image, int x, int y, int width, int height, Rgba color);
void fill_disc(Image8& image, double cx, double cy, double radius, Rgba color);  // antialiased
/// Whether pixel (x, y) lies on a diagonal hatching line.
bool on_hatch(int x, int y, int spacing_px);
/// Each pixel `factor` times in both directions.
Image8 enlarge(const Image8& image, int factor);
/// The factor that brings small sensor images to a size at which text and lines are crisp.
int enlargement(int width);

}  // namespace planescope::render
