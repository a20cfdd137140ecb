#include <algorithm>
#include <fstream>

#include "core/lab/bench/chain_speed.hpp"

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace planescope::lab {
namespace {

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
                         ours_with(subject, profile), classifier});
  for (const planes::Method method : planes::built_methods()) {
    const bool on_images = method == planes::Method::pcl_multi_plane;
    if (method == planes::Method::ours || method == planes::Method::region_growing ||
        (on_images && subject.frames[0].is_cloud()))
      continue;
    methods.push_back(rival(method));
  }
  return methods;
}

/// What the process has resident more than before, at the most, while `work` runs; 0 where the
/// system does not tell.
double peak_of(const std::function<void()>& work) {
#if defined(__GLIBC__)
  malloc_trim(0);  // what is free already would hide what is needed
#endif
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak is what is there now
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
  for (std::vector<double>& found : planes)
    found.erase(found.begin());  // of the round that warms up
  for (std::size_t m = 0; m < methods.size(); ++m)
    rows.push_back({.recording = subject.name,
                    .method = methods[m].name,
                    .ms = times_of(ms[m]),
                    .ratio = median_ratio(ms[m], ms[0]),
                    .planes = median(planes[m])});
  return rows;
}

std::vector<MethodRow> measure_method_memory(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<MethodRow> rows;
  for (const ChainMethod& method : methods_of(subject, tools)) {
    const auto run = [&] {
      planes::run_frame(subject.frames[0], method.options, method.classifier);
    };
    const auto allocations = steady_allocations(subject, tools, run);
    rows.push_back({.recording = subject.name,
                    .method = method.name,
                    .allocations = allocations,
                    .peak_mib = peak_of(run)});
  }
  return rows;
}

}  // namespace planescope::lab
