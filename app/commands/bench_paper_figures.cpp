#include "app/commands/bench_paper_figures.hpp"

namespace planescope {

std::vector<PaperFigure> draw_paper_figures(const PaperFigureArgs&,
                                            const PaperResults&,
                                            Renderer&) {
  return {};
}

}  // namespace planescope
