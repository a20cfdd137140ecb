#include "core/lab/experiments/measure_real.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/lab/experiments/paper_plan.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {
namespace {

std::vector<CellKey> and_ablation(std::vector<CellKey> methods) {
  for (const std::string& term : objective_terms(true))
    methods.push_back(with_ours({}, "refined", "gcn", without(term)));
  return methods;
}

std::vector<CellKey> and_rivals(std::vector<CellKey> methods) {
  for (const planes::Method method : planes::built_methods())
    if (method != planes::Method::ours)
      methods.push_back(with_rival({}, planes::to_string(method)));
  return methods;
}

std::vector<CellKey> real_methods() {
  return and_rivals(and_ablation({with_ours({}, "refined", "gcn"), with_ours({}, "paper", "gcn"),
                                  with_ours({}, "paper-closest", "gcn")}));
}

std::vector<CellKey> set_methods() {
  return and_rivals(and_ablation({with_ours({}, "refined", "gcn")}));
}

std::vector<planes::Metrics> score_by_pixel(const EvaluationFrame& frame,
                                            std::span<const CellKey> methods,
                                            const Labellers& labellers,
                                            std::optional<double> max_range_m,
                                            const planes::LeastTruePlane& least) {
  const planes::SourceTruth truth = truth_of(frame);
  Contest contest(frame.frame, labellers, &truth, max_range_m);
  std::vector<planes::Metrics> scores;
  for (const CellKey& method : methods)
    scores.push_back(planes::score_frame(contest.run(method), truth, least));
  return scores;
}

std::vector<MethodScores> with_names(const std::vector<CellKey>& methods,
                                     std::vector<std::vector<planes::Metrics>> scores) {
  std::vector<MethodScores> named;
  for (std::size_t m = 0; m < methods.size(); ++m)
    named.push_back({methods[m], std::move(scores[m])});
  return named;
}

/// What a method finds in a frame of a recording.
struct Seen {
  PixelPlanes planes;
  FloorPieces floor;
};

}  // namespace

EvaluationFrame read_listed(const ListedFrame& listed,
                            const std::filesystem::path& data,
                            const std::filesystem::path& labels) {
  const LabelledName& name = listed.name;
  const auto recording = io::open_recording(data / name.recording, listed.reading.recording);
  if (name.frame >= recording->frame_count())
    throw Error(fmt::format("{}: {} is frame {}, found {} frames", (data / name.recording).string(),
                            name.name, name.frame, recording->frame_count()));
  EvaluationFrame out;
  out.name = name.name;
  out.frame = recording->frame(name.frame);
  out.frame.gravity = planes::resolve_gravity(out.frame, listed.reading.gravity);
  const std::filesystem::path dir = labels / name.name;
  out.labels = labels::read_frame_labels(dir, name.frame, recording->frame_hash(name.frame));
  if (!out.labels)
    throw Error(fmt::format("{}: no labels of frame {}, expected {:06}.json", dir.string(),
                            name.frame, name.frame));
  return out;
}

LabelledScores measure_labelled(std::span<const ListedFrame> listed,
                                std::span<const EvaluationFrame> frames,
                                const CellTools& tools,
                                const std::function<void(int, int)>& progress) {
  const std::vector<CellKey> methods = real_methods();
  LabelledScores result;
  for (const ListedFrame& one : listed) result.frames.push_back(one.name);
  const auto measure = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    return score_by_pixel(frames[k], methods, tools, listed[k].reading.max_range_m,
                          {.points = kLeastTruePixels});
  };
  result.methods = with_names(
      methods, of_methods<planes::Metrics>(methods.size(), static_cast<int>(frames.size()),
                                           tools.threads, measure, progress));
  return result;
}

SetScores measure_set(const CellKey& set,
                      int count,
                      const CellTools& tools,
                      const std::function<void(int, int)>& progress) {
  const std::vector<CellKey> methods = set_methods();
  PaperPlan plan;
  plan.count = count;
  const int frames = planned_frames(plan, set.set);
  const auto measure = [&](int i) {
    return score_by_pixel(cell_frame(set, i, tools), methods, tools, {},
                          {.voxels = kMinTruthVoxels});
  };
  return {set, with_names(methods, of_methods<planes::Metrics>(methods.size(), frames,
                                                               tools.threads, measure, progress))};
}

RepeatScores measure_repeat(const io::Recording& recording,
                            const Reading& reading,
                            int count,
                            const CellTools& tools,
                            const std::function<void(int, int)>& progress) {
  const std::vector<CellKey> methods = real_methods();
  RepeatScores result;
  result.frames = recording.frame_count();
  if (count > 0) result.frames = std::min(result.frames, count);
  const auto measure = [&](int i) {
    Frame frame = recording.frame(i);
    frame.gravity = planes::resolve_gravity(frame, reading.gravity);
    Contest contest(frame, tools, nullptr, reading.max_range_m);
    const std::vector<std::uint8_t> floor = floor_pixels(contest.prepared("gcn", methods[0]));
    std::vector<Seen> seen;
    for (const CellKey& method : methods) {
      Seen& by_method = seen.emplace_back(Seen{pixel_planes(contest.run(method)), {}});
      by_method.floor = floor_pieces(floor, by_method.planes);
    }
    return seen;
  };
  const auto seen =
      of_methods<Seen>(methods.size(), result.frames, tools.threads, measure, progress);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    RepeatScores::OfMethod& scores = result.methods.emplace_back();
    scores.method = methods[m];
    for (std::size_t i = 0; i + 1 < seen[m].size(); ++i)
      scores.neighbours.push_back(compare_neighbours(seen[m][i].planes, seen[m][i + 1].planes));
    for (const Seen& frame : seen[m]) scores.floor.push_back(frame.floor);
  }
  return result;
}

}  // namespace planescope::lab
