#include "core/lab/synthetic/evaluation_sets.hpp"

#include "core/model/error.hpp"

namespace planescope::lab {
namespace {

constexpr DepthErrors kAllErrors[] = {DepthErrors::clean, DepthErrors::noise, DepthErrors::d435};

}  // namespace

const char* to_string(DepthErrors errors) {
  switch (errors) {
    case DepthErrors::clean:
      return "clean";
    case DepthErrors::noise:
      return "noise";
    case DepthErrors::d435:
      break;
  }
  return "d435";
}

DepthErrors parse_depth_errors(const std::string& text) {
  for (const DepthErrors errors : kAllErrors)
    if (text == to_string(errors)) return errors;
  throw Error("depth errors \"" + text + "\" are not known, expected one of clean, noise, d435");
}

const std::vector<EvaluationSet>& evaluation_sets() {
  static const std::vector<EvaluationSet> sets = {
      {"stairs", "the paper's: a riser and a tread per step", false, 100},
      {"side_walls", "stairs between one or two walls that risers and treads meet", false, 24},
      {"open_risers", "treads as slabs 3 to 5 cm thick, floating one above the other over ground",
       false, 24},
      {"equal_boxes",
       "boxes of one height, 5 to 30 cm apart: tops in one plane, each a true plane of its own",
       false, 24},
      {"ramps", "a ramp of 5 to 25 degrees and its sides, level ground around it", false, 24},
      {"kerbs", "a kerb of 2 to 15 cm between road and pavement, straight or around a corner",
       false, 24},
      {"spiral", "wedge-shaped steps around a pole, which is curved and no plane", false, 24},
      {"depth_stairs", "a camera's views of stairs of 2 to 6 steps, half of them before a wall",
       true, 12},
      {"depth_boxes", "a camera's views of 3 to 6 boxes of several sizes and headings", true, 12},
      {"depth_slopes",
       "a camera's views of ramps of 5 to 35 degrees: alone, up to a pavement, or beside one", true,
       12}};
  return sets;
}

const EvaluationSet& find_evaluation_set(const std::string& name) {
  std::string known;
  for (const EvaluationSet& set : evaluation_sets()) {
    if (set.name == name) return set;
    known += (known.empty() ? "" : ", ") + set.name;
  }
  throw Error("evaluation set \"" + name + "\" is not known, expected one of " + known);
}

}  // namespace planescope::lab
