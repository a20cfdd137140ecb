#include "core/lab/experiments/outline_results.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/lab/bench/result_json.hpp"

namespace planescope::lab {
namespace {

using Json = nlohmann::ordered_json;

FootScore sum_of(FootScore a, const FootScore& b) {
  a.steppable += b.steppable;
  a.places += b.places;
  a.off += b.off;
  a.hidden += b.hidden;
  a.spaces += b.spaces;
  a.invalid += b.invalid;
  a.area_m2 += b.area_m2;
  a.covered_m2 += b.covered_m2;
  a.pieces += b.pieces;
  a.least_covered = std::min(a.least_covered, b.least_covered);
  return a;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)))];
}

OutlineSummary summary_of(const OutlineResults& results, const std::string& set) {
  OutlineSummary summary;
  summary.set = set;
  std::vector<double> ious, drawn;
  std::array<int, 3> within = {};
  for (const OutlineResults::OfSet& of_set : results.sets) {
    if (set != "all" && of_set.set != set) continue;
    for (const OutlineFrameScore& frame : of_set.frames) {
      ++summary.frames;
      summary.foot = sum_of(summary.foot, frame.foot);
      for (const OutlineScore& plane : frame.planes) {
        if (plane.true_m2 < kLeastTrueM2) continue;
        ++summary.planes;
        if (plane.found == 0) continue;
        ++summary.found;
        ious.push_back(plane.iou);
        drawn.push_back(plane.drawn_iou);
        if (plane.iou < kLeastKnownIou) continue;
        ++summary.known;
        for (std::size_t i = 0; i < 3; ++i) within[i] += std::abs(plane.off_sigmas[i]) <= 2;
      }
    }
  }
  summary.iou_median = quantile(ious, 0.5);
  summary.iou_low = quantile(ious, 0.05);
  summary.drawn_median = quantile(drawn, 0.5);
  summary.drawn_low = quantile(drawn, 0.05);
  for (std::size_t i = 0; i < 3 && summary.known > 0; ++i) {
    summary.within[i] = static_cast<double>(within[i]) / summary.known;
    summary.within_all += summary.within[i] / 3;
  }
  return summary;
}

std::string share_text(double share) { return fixed(100 * share, 1); }

Json number(double value) {
  return std::isfinite(value) ? Json(std::round(value * 1e6) / 1e6) : Json();
}

}  // namespace

std::vector<OutlineSummary> outline_summaries(const OutlineResults& results) {
  std::vector<std::string> names;
  for (const OutlineResults::OfSet& of_set : results.sets)
    if (std::ranges::find(names, of_set.set) == names.end()) names.push_back(of_set.set);
  names.emplace_back("all");
  std::vector<OutlineSummary> summaries;
  for (const std::string& name : names) summaries.push_back(summary_of(results, name));
  return summaries;
}

std::vector<Table> outline_tables(const OutlineResults& results) {
  Table outlines{
      "Outlines",
      fmt::format("True planes of which {:.0f} cm2 and more are in view and in range, how "
                  "many a found plane stands for, and of these the IoU of what an outline "
                  "covers with all of the true plane that both imagers' fields of view "
                  "hold, measured or not, median and 5th percentile: of the found plane's "
                  "outline, and of one drawn about the true plane's pixels",
                  kLeastTrueM2 * 1e4),
      {"set", "frames", "planes", "found", "IoU", "5 %", "true pixels", "5 %"},
      {}};
  Table certainty{"Certainty",
                  fmt::format("Of found planes with an IoU of {} and more, the share [%] that the "
                              "true plane is within 2 sigma of: by the tilt along its longer and "
                              "along its shorter extent, by its offset, by any of the three",
                              kLeastKnownIou),
                  {"set", "planes", "long tilt", "short tilt", "offset", "all"},
                  {}};
  Table feet{
      "Places for a foot",
      fmt::format("A foot of radius {} m. Planes with room for it; of these, those with an area "
                  "that is not valid or pieces that are not convex or not inside; convex pieces of "
                  "a plane, the share of the area that they cover, of all planes and the least; "
                  "steppable planes, places for the foot's centre on these, one every 2 cm; where "
                  "the foot is over a hole or more than 2 cm off the true surfaces, and where one "
                  "that is more than 2 cm off the plane hides it from the camera",
                  results.foot_radius_m),
      {"set", "with room", "unsound", "pieces", "covered [%]", "least [%]", "steppable", "places",
       "off", "hidden"},
      {}};
  for (const OutlineSummary& s : outline_summaries(results)) {
    outlines.rows.push_back({s.set, std::to_string(s.frames), std::to_string(s.planes),
                             std::to_string(s.found), fixed(s.iou_median, 3), fixed(s.iou_low, 3),
                             fixed(s.drawn_median, 3), fixed(s.drawn_low, 3)});
    certainty.rows.push_back({s.set, std::to_string(s.known), share_text(s.within[0]),
                              share_text(s.within[1]), share_text(s.within[2]),
                              share_text(s.within_all)});
    const FootScore& f = s.foot;
    feet.rows.push_back({s.set, std::to_string(f.spaces), std::to_string(f.invalid),
                         fixed(f.spaces > 0 ? static_cast<double>(f.pieces) / f.spaces : 0, 2),
                         share_text(f.area_m2 > 0 ? f.covered_m2 / f.area_m2 : 1),
                         share_text(f.least_covered), std::to_string(f.steppable),
                         std::to_string(f.places), std::to_string(f.off),
                         std::to_string(f.hidden)});
  }
  return {outlines, certainty, feet};
}

std::string outline_markdown(const OutlineResults& results) {
  return "# Outlines, certainty, places for a foot\n\n    " + results.command + "\n\n" +
         joined(outline_tables(results), to_markdown);
}

std::string outline_json(const OutlineResults& results) {
  Json facts =
      run_json("planescope.bench.outlines/1", results.command, results.build, results.weights);
  facts["foot_radius_m"] = results.foot_radius_m;
  JsonLines json(facts);
  std::vector<std::string> summaries, frames;
  for (const OutlineSummary& s : outline_summaries(results))
    summaries.push_back(json_line({{"set", s.set},
                                   {"frames", s.frames},
                                   {"planes", s.planes},
                                   {"found", s.found},
                                   {"drawn_iou_median", number(s.drawn_median)},
                                   {"drawn_iou_low", number(s.drawn_low)},
                                   {"iou_median", number(s.iou_median)},
                                   {"iou_low", number(s.iou_low)},
                                   {"known", s.known},
                                   {"within_2_sigma", s.within},
                                   {"with_room", s.foot.spaces},
                                   {"unsound", s.foot.invalid},
                                   {"pieces", s.foot.pieces},
                                   {"least_covered", number(s.foot.least_covered)},
                                   {"steppable", s.foot.steppable},
                                   {"places", s.foot.places},
                                   {"off", s.foot.off},
                                   {"hidden", s.foot.hidden}}));
  for (const OutlineResults::OfSet& of_set : results.sets)
    for (std::size_t i = 0; i < of_set.frames.size(); ++i) {
      const OutlineFrameScore& frame = of_set.frames[i];
      Json planes = Json::array();
      for (const OutlineScore& p : frame.planes) {
        Json plane = {{"true_m2", number(p.true_m2)},
                      {"drawn_iou", number(p.drawn_iou)},
                      {"found", p.found},
                      {"iou", number(p.iou)}};
        if (p.found > 0) {
          plane["off_sigmas"] = {number(p.off_sigmas[0]), number(p.off_sigmas[1]),
                                 number(p.off_sigmas[2])};
          plane["range_m"] = number(p.range_m);
          plane["voxels"] = p.voxels;
        }
        planes.push_back(plane);
      }
      frames.push_back(json_line({{"set", of_set.set},
                                  {"seed", of_set.seed},
                                  {"frame", i},
                                  {"planes", planes},
                                  {"places", frame.foot.places},
                                  {"off", frame.foot.off},
                                  {"hidden", frame.foot.hidden},
                                  {"unsound", frame.foot.invalid}}));
    }
  json.add("sets", summaries);
  json.add("frames", frames);
  return std::move(json).text();
}

}  // namespace planescope::lab
