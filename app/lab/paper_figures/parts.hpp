#pragma once

// What the paper's figures share. Included by app/lab/paper_figures/ and its caller only.

#include <memory>
#include <string>
#include <vector>

#include "app/lab/bench_paper.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "render/draw_list.hpp"

namespace planescope::app::figures {

struct Work {
  const PaperFigureArgs& args;
  const lab::PaperResults& results;
  render::Renderer& renderer;
  std::shared_ptr<const planes::Classifier> network;

  /// Before each picture. Throws Cancelled.
  void begin(const std::string& what) const;
};

lab::PaperFigure stairs_noise(const Work& work);
lab::PaperFigure real_scenes(const Work& work);
lab::PaperFigure node_cases(const Work& work);
lab::PaperFigure stages(const Work& work);
lab::PaperFigure failures(const Work& work);

/// One way to segment a frame, as cells of the tables have it: with_ours(), with_rival().
struct Contestant {
  std::string name;
  lab::CellKey key;
};
/// With the threads of this work.
planes::PipelineOptions options_of(const lab::CellKey& key, const Work& work);

/// `copy_width`: at most, of the copy in the page [px].
void add_picture(lab::PaperFigure& figure,
                 const std::string& row,
                 const std::string& column,
                 const std::string& caption,
                 const Image8& image,
                 int copy_width = 640);

/// "11 planes, 0.4 % in none"
std::string planes_text(const planes::FrameResult& result);

/// A colour id per found plane: that of the true plane it stands for, or one that no true plane
/// has.
std::vector<int> colors_by_truth(const planes::JudgedFrame& judged, std::size_t planes);

/// The points in the colours of their planes, those in none dark; nothing else.
render::DrawList bare_planes(std::span<const Vec3f> points,
                             std::span<const std::int32_t> plane_of,
                             std::span<const int> color_of_plane);

/// A list without title, legend, axes, scale bar and gravity: what stands around the picture says
/// it.
render::DrawList bare(render::DrawList list);

/// Looks along `forward` at the middle of the points, as near as holds them all.
render::Camera close_camera(std::span<const Vec3f> points, const Vec3d& forward, double aspect);

}  // namespace planescope::app::figures
