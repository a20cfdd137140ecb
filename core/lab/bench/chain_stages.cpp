#include <algorithm>

#include "core/lab/bench/chain_speed.hpp"

namespace planescope::lab {

planes::PipelineOptions ours_with(const SpeedSubject& subject, planes::Profile profile) {
  planes::PipelineOptions options = subject.options;
  options.method = planes::Method::ours;
  options.segment = planes::profile_options(profile);
  options.threads = 1;
  return options;
}

std::optional<Allocations> steady_allocations(const SpeedSubject& subject,
                                              const SpeedTools& tools,
                                              const std::function<void()>& work) {
  constexpr int kBefore = 2;
  for (int run = 0; run < kBefore; ++run) {
    tools.before(subject.name);
    work();
  }
  if (tools.count_allocations) return tools.count_allocations(work);
  return std::nullopt;
}

namespace {

struct ChainStage {
  std::string name;
  Work work;
  std::function<void()> run;
};

/// Of frame `i`; what goes into each is computed here. The frames must outlive them.
std::vector<ChainStage> stages_of(const SpeedSubject& subject,
                                  std::size_t i,
                                  const SpeedTools& tools) {
  const Frame& frame = subject.frames[i];
  const planes::PipelineOptions paper = ours_with(subject, planes::Profile::paper);
  const planes::PipelineOptions refined = ours_with(subject, planes::Profile::refined);
  const auto prepared = std::make_shared<const planes::PreparedFrame>(
      planes::prepare_frame(frame, paper, tools.gcn.get()));
  const auto of_refined = std::make_shared<const planes::PreparedFrame>(
      planes::prepare_frame(frame, refined, tools.gcn.get()));
  const planes::Cloud& cloud = prepared->cloud;
  const planes::VoxelCloud& voxels = prepared->voxels;
  const std::size_t frame_bytes = frame.is_cloud()
                                      ? frame.cloud->points.size() * sizeof(Vec3f)
                                      : frame.depth.data.size() * sizeof(std::uint16_t);
  const std::size_t color_bytes =
      frame.is_cloud() ? frame.cloud->rgb.size() : frame.color.data.size();
  const std::size_t measured = cloud.points.size(), n = voxels.points.size();

  std::vector<ChainStage> stages;
  if (subject.load)
    stages.push_back(
        {"load", load_work(frame_bytes, color_bytes), [&subject, i] { subject.load(i); }});
  if (prepared->gravity.source == GravitySource::estimate)
    stages.push_back({"gravity, estimated", gravity_work(frame_bytes),
                      [&frame, refined] { planes::resolve_gravity(frame, refined.gravity); }});
  stages.push_back({"cloud", cloud_work(frame_bytes, measured), [&frame, prepared, refined] {
                      planes::make_cloud(frame, prepared->gravity, refined.cloud);
                    }});
  stages.push_back({"voxel grid", voxel_work(measured, cloud.counts.kept, n), [prepared, refined] {
                      planes::voxelize(prepared->cloud, refined.cloud.voxel_size_m);
                    }});
  if (prepared->gravity.known()) {
    stages.push_back({"classifier gcn", gcn_work(n, tools.network),
                      [prepared, gcn = tools.gcn] { gcn->classify(prepared->voxels.points, 1); }});
    stages.push_back({"classifier pca", pca_work(n, tools.pca_options.neighbours),
                      [prepared, pca = tools.pca] { pca->classify(prepared->voxels.points, 1); }});
  }
  stages.push_back({"octree", octree_work(n), [prepared] {
                      planes::build_octree(prepared->voxels.points, prepared->classification.labels,
                                           prepared->cloud.cube);
                    }});
  stages.push_back({"segmentation paper", segment_work(n, measured, false),
                    [&frame, prepared, paper] { planes::find_regions(frame, *prepared, paper); }});
  stages.push_back(
      {"segmentation refined", segment_work(n, measured, true),
       [&frame, of_refined, refined] { planes::find_regions(frame, *of_refined, refined); }});
  return stages;
}

}  // namespace

std::vector<StageRow> measure_stages(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<std::vector<ChainStage>> of_frames;
  for (std::size_t i = 0; i < subject.frames.size(); ++i) {
    tools.before(subject.name);
    of_frames.push_back(stages_of(subject, i, tools));
  }
  // Frames differ in whether their gravity is known; what one has not, all leave out.
  const auto in_all = [&](const ChainStage& stage) {
    return std::ranges::all_of(of_frames, [&](const std::vector<ChainStage>& stages) {
      return std::ranges::count(stages, stage.name, &ChainStage::name) == 1;
    });
  };
  std::vector<std::string> names;
  for (const ChainStage& stage : of_frames[0])
    if (in_all(stage)) names.push_back(stage.name);
  const auto stage_at = [&](std::size_t s, int round) -> const ChainStage& {
    const auto& stages = of_frames[static_cast<std::size_t>(round) % of_frames.size()];
    return *std::ranges::find(stages, names[s], &ChainStage::name);
  };

  const auto ms = interleaved_ms(
      names.size(), tools.rounds, [&] { tools.before(subject.name); },
      [&](std::size_t s, int round) { stage_at(s, round).run(); }, Clock::thread_cpu);
  std::vector<StageRow> rows;
  for (std::size_t s = 0; s < names.size(); ++s) {
    StageRow row{.recording = subject.name, .stage = names[s], .ms = times_of(ms[s])};
    std::vector<double> floors_ms;
    std::vector<Work> works;
    for (int round = 0; round < tools.rounds; ++round) {
      works.push_back(stage_at(s, round).work);
      floors_ms.push_back(floor_of(works.back(), tools.peaks).ms);
    }
    row.ratio = median_ratio(ms[s], floors_ms);
    const auto middle = works.begin() + std::ssize(works) / 2;
    std::ranges::nth_element(works, middle, {},
                             [&](const Work& work) { return floor_of(work, tools.peaks).ms; });
    row.work = *middle;
    row.floor = floor_of(row.work, tools.peaks);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<StageRow> measure_stage_memory(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<StageRow> rows;
  for (const ChainStage& stage : stages_of(subject, 0, tools))
    rows.push_back({.recording = subject.name,
                    .stage = stage.name,
                    .work = stage.work,
                    .allocations = steady_allocations(subject, tools, stage.run)});
  return rows;
}

}  // namespace planescope::lab
