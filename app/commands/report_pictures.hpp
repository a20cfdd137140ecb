#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/model/error.hpp"
#include "core/report/data/report_data.hpp"
#include "render/renderer.hpp"

namespace planescope::app {

/// "#rrggbb".
std::string css_color(render::Rgba color);

/// Drawing failed, as opposed to writing the picture.
struct DrawingFailed : Error {
  using Error::Error;
};

struct PictureJob {
  std::filesystem::path dir;       // the frame's folder, with `pictures` and `report` in it
  std::filesystem::path relative;  // the same folder, as the report names it
  int copy_width = 1280;           // of the copies in the page [px]
  double max_range_m = 1.5;
  planes::Method method = planes::Method::ours;  // others have no labels and no octree to draw
};

/// One picture per stage, written as PNG, with two smaller copies for the page. Without a renderer
/// only those that are made in image space. The same frame gives the same pixels for any thread
/// count.
std::vector<report::ReportPicture> draw_pictures(const LoadedFrame& loaded,
                                                 const std::vector<int>& color_of_plane,
                                                 render::Renderer* renderer,
                                                 const PictureJob& job);

}  // namespace planescope::app
