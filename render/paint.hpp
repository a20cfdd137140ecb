#pragma once

// Small marks and text painted into an RGB image on the CPU: for overlays on camera images.

#include <string>

#include "core/model/types.hpp"
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

/// Text in the one typeface (font.hpp). (x, y): left end of the baseline [px]. Returns the advance
/// [px].
double draw_text(
    Image8& image, double x, double y, const std::string& utf8, double size_px, Rgba color);
double text_width(const std::string& utf8, double size_px);

}  // namespace planescope::render
