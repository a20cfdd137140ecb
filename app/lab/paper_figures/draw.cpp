#include "app/lab/paper_figures/parts.hpp"

namespace planescope::app {

std::vector<lab::PaperFigure> draw_paper_figures(const PaperFigureArgs& args,
                                                 const lab::PaperResults& results,
                                                 render::Renderer& renderer) {
  planes::PipelineOptions options;
  options.classifier = args.weights;
  const figures::Work work{args, results, renderer, choose_classifier(options).classifier};
  std::vector<lab::PaperFigure> figures;
  for (const auto draw : {figures::stairs_noise, figures::real_scenes, figures::stages,
                          figures::node_cases, figures::failures}) {
    lab::PaperFigure figure = draw(work);
    if (!figure.pictures.empty()) figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace planescope::app
