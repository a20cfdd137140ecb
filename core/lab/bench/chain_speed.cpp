#include "core/lab/bench/chain_speed.hpp"

#include <algorithm>
#include <fstream>

#include "core/planes/rivals/ransac.hpp"

namespace planescope::lab {
namespace {

// ---- Stages ----

struct ChainStage {
  std::string name;
  Work work;
  std::function<void()> run;
};

planes::PipelineOptions with_profile(const SpeedSubject& subject, planes::Profile profile) {
  planes::PipelineOptions options = subject.options;
  options.method = planes::Method::ours;
  options.segment = planes::profile_options(profile);
  options.threads = 1;
  return options;
}

/// Of frame `i`; what goes into each is computed here. The frames must outlive them.
std::vector<ChainStage> stages_of(const SpeedSubject& subject,
                                  std::size_t i,
                                  const SpeedTools& tools) {
  const Frame& frame = subject.frames[i];
  const planes::PipelineOptions paper = with_profile(subject, planes::Profile::paper);
  const planes::PipelineOptions refined = with_profile(subject, planes::Profile::refined);
  const auto prepared = std::make_shared<const planes::PreparedFrame>(
      planes::prepare_frame(frame, refined, tools.gcn.get()));
  const planes::Cloud& cloud = prepared->cloud;
  const planes::VoxelCloud& voxels = prepared->voxels;
  const std::size_t pixels =
      frame.is_cloud() ? frame.cloud->points.size() : frame.depth.data.size();
  const std::size_t measured = cloud.points.size(), n = voxels.points.size();

  std::vector<ChainStage> stages;
  if (subject.load)
    stages.push_back(
        {"load", load_work(pixels, frame.color.data.size()), [&subject, i] { subject.load(i); }});
  if (!frame.gravity && refined.gravity.mode != planes::GravityMode::fixed)
    stages.push_back({"gravity, estimated", load_work(pixels, 0),
                      [&frame, refined] { planes::resolve_gravity(frame, refined.gravity); }});
  stages.push_back({"cloud", cloud_work(pixels, measured), [&frame, prepared, refined] {
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
  const auto add_segmentation = [&](const char* name, const planes::PipelineOptions& options,
                                    bool reads_pixels) {
    stages.push_back({name, segment_work(n, measured, reads_pixels), [&frame, prepared, options] {
                        planes::find_regions(frame, *prepared, options);
                      }});
  };
  add_segmentation("segmentation paper", paper, false);
  add_segmentation("segmentation refined", refined, true);
  return stages;
}

// ---- Methods ----

struct ChainMethod {
  std::string name;
  planes::PipelineOptions options;
  const planes::Classifier* classifier = nullptr;
};

std::vector<ChainMethod> methods_of(const SpeedSubject& subject, const SpeedTools& tools) {
  const auto rival = [&](planes::Method method) {
    planes::PipelineOptions options = subject.options;
    options.method = method;
    options.threads = 1;
    return ChainMethod{planes::to_string(method), options, nullptr};
  };
  std::vector<ChainMethod> methods = {rival(planes::Method::region_growing)};
  for (const planes::Profile profile : {planes::Profile::paper, planes::Profile::refined})
    for (const auto& [name, classifier] :
         {std::pair("gcn", tools.gcn.get()), std::pair("pca", tools.pca.get())})
      methods.push_back({std::string("ours, ") + planes::to_string(profile) + ", " + name,
                         with_profile(subject, profile), classifier});
  for (const planes::Method method : planes::built_methods()) {
    const bool on_images = method == planes::Method::pcl_multi_plane;
    if (method == planes::Method::ours || method == planes::Method::region_growing ||
        (on_images && subject.frames[0].is_cloud()))
      continue;
    methods.push_back(rival(method));
  }
  return methods;
}

// ---- Memory ----

/// The most memory that this process has had resident; since reset_peak(), where the system allows
/// that. 0: not known.
double peak_resident_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

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

std::vector<MethodRow> measure_methods(const SpeedSubject& subject, const SpeedTools& tools) {
  const std::vector<ChainMethod> methods = methods_of(subject, tools);
  std::vector<std::vector<double>> planes(methods.size());
  // What Open3D, PCL and CGAL would do on other threads counts as well.
  const auto ms = interleaved_ms(
      methods.size(), tools.rounds, [&] { tools.before(subject.name); },
      [&](std::size_t m, int round) {
        const Frame& frame =
            subject.frames[static_cast<std::size_t>(round) % subject.frames.size()];
        const planes::FrameResult result =
            planes::run_frame(frame, methods[m].options, methods[m].classifier);
        planes[m].push_back(static_cast<double>(result.segmentation.planes.size()));
      },
      Clock::process_cpu);
  std::vector<MethodRow> rows;
  for (std::size_t m = 0; m < methods.size(); ++m)
    rows.push_back({.recording = subject.name,
                    .method = methods[m].name,
                    .ms = times_of(ms[m]),
                    .ratio = median_ratio(ms[m], ms[0]),
                    .planes = median(planes[m])});
  return rows;
}

Memory measure_memory(const SpeedSubject& subject, const SpeedTools& tools) {
  constexpr int kBefore = 2;  // what is kept from run to run is there then
  const auto count = [&](const std::function<void()>& work) -> std::optional<Allocations> {
    for (int run = 0; run < kBefore; ++run) {
      tools.before(subject.name);
      work();
    }
    if (tools.count_allocations) return tools.count_allocations(work);
    return std::nullopt;
  };
  Memory memory;
  for (const ChainStage& stage : stages_of(subject, 0, tools))
    memory.stages.push_back({.recording = subject.name,
                             .stage = stage.name,
                             .work = stage.work,
                             .allocations = count(stage.run)});
  for (const ChainMethod& method : methods_of(subject, tools)) {
    reset_peak();
    const auto allocations =
        count([&] { planes::run_frame(subject.frames[0], method.options, method.classifier); });
    memory.methods.push_back({.recording = subject.name,
                              .method = method.name,
                              .allocations = allocations,
                              .peak_mib = peak_resident_mib()});
  }
  return memory;
}

}  // namespace planescope::lab
