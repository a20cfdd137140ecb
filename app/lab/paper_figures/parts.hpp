#pragma once

// What the paper's figures share. Included by app/lab/paper_figures/ and its caller only.

#include <memory>
#include <string>
#include <vector>

#include "app/lab/bench_paper_figures.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/score.hpp"
#include "render/draw_list.hpp"

namespace planescope::figures {

struct Work {
  const PaperFigureArgs& args;
  const PaperResults& results;
  Renderer& renderer;
  std::shared_ptr<const Classifier> network;

  /// Before each picture. Throws Cancelled.
  void begin(const std::string& what) const;
};

PaperFigure stairs_noise(const Work& work);
PaperFigure real_scenes(const Work& work);
PaperFigure node_cases(const Work& work);
PaperFigure stages(const Work& work);
PaperFigure failures(const Work& work);

/// One way to segment a frame, as cells of the tables have it: with_ours(), with_rival().
struct Contestant {
  std::string name;
  CellKey key;
};
/// With the threads of this work.
PipelineOptions options_of(const CellKey& key, const Work& work);

/// `copy_width`: at most, of the copy in the page [px].
void add_picture(PaperFigure& figure,
                 const std::string& row,
                 const std::string& column,
                 const std::string& caption,
                 const Image8& image,
                 int copy_width = 640);

/// "11 planes, 0.4 % in none"
std::string planes_text(const FrameResult& result);

/// A colour id per found plane: that of the true plane it stands for, or one that no true plane
/// has.
std::vector<int> colors_by_truth(const JudgedFrame& judged, std::size_t planes);

/// The points in the colours of their planes, those in none dark; nothing else.
DrawList bare_planes(std::span<const Vec3f> points,
                     std::span<const std::int32_t> plane_of,
                     std::span<const int> color_of_plane);

/// A list without title, legend, axes, scale bar and gravity: what stands around the picture says
/// it.
DrawList bare(DrawList list);

/// Looks along `forward` at the middle of the points, as near as holds them all.
Camera close_camera(std::span<const Vec3f> points, const Vec3d& forward, double aspect);

}  // namespace planescope::figures
