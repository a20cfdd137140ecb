// Times the stages from a frame to its planes, and whole commands.

#include "core/lab/bench/chain_speed.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "core/lab/rivals/rivals.hpp"
#include "core/model/error.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace planescope::lab {

// ---- Stages ----

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

/// The stages of frame `i`; their inputs are computed here. The frames must outlive them.
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
    stages.push_back({"classifier pca", pca_work(n, tools.pca_options.neighbors),
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
  // Frames differ in whether their gravity is known; omit stages that any of them lacks.
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
    StageRow row{.stage = names[s], .ms = times_of(ms[s])};
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
    rows.push_back({.stage = stage.name,
                    .work = stage.work,
                    .allocations = steady_allocations(subject, tools, stage.run)});
  return rows;
}

// ---- Stages of other libraries ----

namespace {

struct Duel {
  std::string stage, rival;
  std::function<void()> ours, theirs;
};

std::vector<Duel> duels_of(const SpeedSubject& subject, std::size_t i, const SpeedTools& tools) {
  const planes::PipelineOptions options = ours_with(subject, planes::Profile::paper);
  const auto prepared = std::make_shared<const planes::PreparedFrame>(
      planes::prepare_frame(subject.frames[i], options, tools.pca.get()));
  const double voxel_m = options.cloud.voxel_size_m;
  std::vector<Duel> duels;
  if (tools.open3d_voxels && voxel_m > 0)
    duels.push_back({"voxel grid", "Open3D VoxelDownSample",
                     [prepared, voxel_m] { planes::voxelize(prepared->cloud, voxel_m); },
                     tools.open3d_voxels(prepared->cloud, voxel_m)});
  if (tools.open3d_octree) {
    // Ours skips most nodes; Open3D's creates all of them.
    const auto every_node = [prepared] {
      const planes::Cube& cube = prepared->cloud.cube;
      planes::Octree octree =
          planes::build_octree(prepared->voxels.points, prepared->classification.labels, cube);
      for (std::size_t node = 0; node < octree.nodes.size(); ++node)
        if (octree.nodes[node].depth < cube.max_depth)
          planes::divide(octree, static_cast<std::int32_t>(node));
    };
    duels.push_back({"octree, every node", "Open3D Octree", every_node,
                     tools.open3d_octree(prepared->voxels.points, prepared->cloud.cube)});
  }
  const std::shared_ptr<const planes::Classifier> nanoflann =
      make_nanoflann_pca_classifier(tools.pca_options);
  duels.push_back({"classifier pca", "nanoflann and Eigen",
                   [prepared, pca = tools.pca] { pca->classify(prepared->voxels.points, 1); },
                   [prepared, nanoflann] { nanoflann->classify(prepared->voxels.points, 1); }});
  return duels;
}

}  // namespace

std::vector<DuelRow> measure_duels(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<std::vector<Duel>> of_frames;
  for (std::size_t i = 0; i < subject.frames.size(); ++i) {
    tools.before(subject.name);
    of_frames.push_back(duels_of(subject, i, tools));
  }
  const std::vector<Duel>& first = of_frames[0];
  const auto ms = interleaved_ms(
      2 * first.size(), tools.rounds, [&] { tools.before(subject.name); },
      [&](std::size_t turn, int round) {
        const Duel& duel = of_frames[static_cast<std::size_t>(round) % of_frames.size()][turn / 2];
        turn % 2 == 0 ? duel.ours() : duel.theirs();
      },
      Clock::thread_cpu);
  std::vector<DuelRow> rows;
  for (std::size_t d = 0; d < first.size(); ++d)
    rows.push_back({.stage = first[d].stage,
                    .rival = first[d].rival,
                    .ours_ms = times_of(ms[2 * d]),
                    .rival_ms = times_of(ms[2 * d + 1]),
                    .ratio = median_ratio(ms[2 * d + 1], ms[2 * d])});
  return rows;
}

// ---- Whole frames ----

namespace {

struct ChainMethod {
  std::string name;
  planes::PipelineOptions options;
  const planes::Classifier* classifier = nullptr;
  const LibraryRival* rival = nullptr;

  planes::FrameResult run(const Frame& frame) const {
    return run_method(frame, options, classifier, rival);
  }
};

std::vector<ChainMethod> methods_of(const SpeedSubject& subject, const SpeedTools& tools) {
  planes::PipelineOptions growing = subject.options;
  growing.method = planes::Method::region_growing;
  growing.threads = 1;
  std::vector<ChainMethod> methods = {{planes::to_string(growing.method), growing}};
  for (const planes::Profile profile : {planes::Profile::paper, planes::Profile::refined})
    for (const auto& [name, classifier] :
         {std::pair("gcn", tools.gcn.get()), std::pair("pca", tools.pca.get())})
      methods.push_back({std::string("ours, ") + planes::to_string(profile) + ", " + name,
                         ours_with(subject, profile), classifier});
  for (const std::string& name : rival_names(!subject.frames[0].is_cloud())) {
    if (name == methods[0].name) continue;
    ChainMethod& method = methods.emplace_back(methods[0]);
    method.name = name;
    method.rival = find_library_rival(name);
    if (!method.rival) method.options.method = planes::parse_method(name);
  }
  return methods;
}

/// Peak increase in resident memory while `work` runs; 0 if the system does not report it.
double peak_of(const std::function<void()>& work) {
#if defined(__GLIBC__)
  malloc_trim(0);  // free memory would hide the memory that `work` needs
#endif
  std::ofstream("/proc/self/clear_refs") << "5";  // resets the peak to the current value
  const ResidentMemory before = resident_memory("/proc/self/status");
  work();
  const double more = resident_memory("/proc/self/status").peak_mib - before.now_mib;
  const bool was_reset = before.peak_mib < before.now_mib + 1;
  return was_reset ? std::max(0.0, more) : 0;
}

}  // namespace

std::vector<MethodRow> measure_methods(const SpeedSubject& subject, const SpeedTools& tools) {
  const std::vector<ChainMethod> methods = methods_of(subject, tools);
  std::vector<std::vector<double>> planes(methods.size());
  // Include CPU time of other threads of Open3D, PCL and CGAL.
  const auto ms = interleaved_ms(
      methods.size(), tools.rounds, [&] { tools.before(subject.name); },
      [&](std::size_t m, int round) {
        const Frame& frame =
            subject.frames[static_cast<std::size_t>(round) % subject.frames.size()];
        const planes::FrameResult result = methods[m].run(frame);
        planes[m].push_back(static_cast<double>(result.segmentation.planes.size()));
      },
      Clock::process_cpu);
  std::vector<MethodRow> rows;
  for (std::vector<double>& found : planes) found.erase(found.begin());  // of the warm-up round
  for (std::size_t m = 0; m < methods.size(); ++m)
    rows.push_back({.method = methods[m].name,
                    .ms = times_of(ms[m]),
                    .ratio = median_ratio(ms[m], ms[0]),
                    .planes = median(planes[m])});
  return rows;
}

std::vector<MethodRow> measure_method_memory(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<MethodRow> rows;
  for (const ChainMethod& method : methods_of(subject, tools)) {
    const auto run = [&] { method.run(subject.frames[0]); };
    const auto allocations = steady_allocations(subject, tools, run);
    rows.push_back({.method = method.name, .allocations = allocations, .peak_mib = peak_of(run)});
  }
  return rows;
}

// ---- Whole commands ----

namespace {

double in_ms(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

/// Peak resident memory of a child, polled every millisecond until it ends. (wait4 would report at
/// least this process's memory, because a spawned child starts in it.)
double followed_peak_mib(pid_t child) {
  double peak_mib = 0;
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == 0) {
    const std::string status = fmt::format("/proc/{}/status", child);
    peak_mib = std::max(peak_mib, resident_memory(status).peak_mib);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return peak_mib;
}

/// Runs the command to its end and returns its resource usage, and its peak memory if requested.
rusage run_to_end(const TimedCommand& command, double* peak_mib = nullptr) {
  std::vector<char*> args;
  for (const std::string& arg : command.args) args.push_back(const_cast<char*>(arg.c_str()));
  args.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // A separate group without blocked signals: Ctrl+C stops only this program. A child stopped
  // half-way would look like a failure.
  posix_spawnattr_t apart;
  posix_spawnattr_init(&apart);
  posix_spawnattr_setflags(&apart, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&apart, &none);
  pid_t child = 0;
  const int failed = posix_spawn(&child, args[0], &quiet, &apart, args.data(), environ);
  posix_spawnattr_destroy(&apart);
  posix_spawn_file_actions_destroy(&quiet);
  if (failed != 0)
    throw Error(fmt::format("{}: cannot be started: {}", command.args[0], std::strerror(failed)));
  if (peak_mib) *peak_mib = followed_peak_mib(child);
  int status = 0;
  rusage used{};
  while (wait4(child, &status, 0, &used) < 0)
    if (errno != EINTR)
      throw Error(
          fmt::format("{}: cannot be waited for: {}", command.args[0], std::strerror(errno)));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(fmt::format("{} ended with {}; expected success", fmt::join(command.args, " "),
                            WIFEXITED(status) ? fmt::format("exit code {}", WEXITSTATUS(status))
                                              : fmt::format("signal {}", WTERMSIG(status))));
  return used;
}

}  // namespace

std::vector<CommandRow> measure_commands(std::span<const TimedCommand> commands,
                                         int rounds,
                                         const std::function<void()>& before) {
  std::vector<std::vector<double>> cpu_ms(commands.size());
  std::vector<CommandRow> rows(commands.size());
  for (std::size_t c = 0; c < commands.size(); ++c) {
    before();
    run_to_end(commands[c], &rows[c].peak_mib);  // separate run, because polling takes time
  }
  const auto wall_ms = interleaved_ms(commands.size(), rounds, before, [&](std::size_t c, int) {
    const rusage used = run_to_end(commands[c]);
    cpu_ms[c].push_back(in_ms(used.ru_utime) + in_ms(used.ru_stime));
  });
  for (std::size_t c = 0; c < commands.size(); ++c) {
    rows[c].name = commands[c].name;
    rows[c].wall_ms = times_of(wall_ms[c]);
    cpu_ms[c].erase(cpu_ms[c].begin());  // of the warm-up round
    rows[c].cpu_ms = times_of(cpu_ms[c]);
  }
  return rows;
}

}  // namespace planescope::lab
