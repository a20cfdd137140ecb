#include "app/commands/synth.hpp"

#include <fmt/format.h>

#include <atomic>
#include <functional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"

namespace planescope::app {
namespace {

struct NamedCloud {
  std::string name;
  PointSet cloud;
};

/// DIR/NAME.ply for each of `count` clouds. Returns how many there are: fewer where stopped.
int write_clouds(const std::filesystem::path& dir,
                 const std::string& task,
                 int count,
                 int threads,
                 const std::stop_token& stop,
                 const std::function<NamedCloud(int)>& make_cloud) {
  std::error_code failed;
  std::filesystem::create_directories(dir, failed);
  if (failed) throw Error("output " + dir.string() + ": " + failed.message());
  std::atomic<int> done = 0;
  Progress progress(task, count);
  const auto make = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) {
      const NamedCloud made = make_cloud(static_cast<int>(i));
      io::write_ply(dir / (made.name + ".ply"), made.cloud);
      ++done;
      if (begin == 0) progress.show(done, "");  // one thread speaks for all
    }
  };
  parallel_for(static_cast<std::size_t>(count), threads, make, 1);
  return done;
}

int write_set_clouds(const SynthSetArgs& args, const std::string& task, std::stop_token stop) {
  const auto make = [&](int i) {
    lab::EvaluationFrame made = lab::make_evaluation_frame(args.set, i, args.options);
    return NamedCloud{std::move(made.name), std::move(*made.frame.cloud)};
  };
  const int done = write_clouds(args.out, task, args.count, args.threads, stop, make);
  fmt::print("{}: {} clouds of {}\n", args.out.string(), done, args.set.name);
  if (stop.stop_requested()) throw Cancelled();
  return 0;
}

int write_set_depth(const SynthSetArgs& args, const std::string& task, std::stop_token stop) {
  const lab::SampleFolder folder{
      fmt::format("planescope {} --errors {}", task, lab::to_string(args.options.errors)),
      args.options.seed, static_cast<std::size_t>(args.count), /*color=*/false, /*gravity=*/true};
  {
    Progress progress(task, args.count);
    lab::write_sample_folder(args.out, folder, [&](std::size_t i) {
      if (stop.stop_requested()) throw Cancelled();
      progress.show(static_cast<int>(i), "");
      lab::EvaluationFrame made =
          lab::make_evaluation_frame(args.set, static_cast<int>(i), args.options);
      return lab::SampleFrame{std::move(made.frame), std::move(*made.labels), std::move(made.name)};
    });
  }
  fmt::print("{}: {} frames of {}, their ground truth in {}\n", args.out.string(), args.count,
             args.set.name, labels::default_label_dir(args.out).string());
  return 0;
}

}  // namespace

int run_synth_sample(const SynthSampleArgs& args) {
  check_output_dir(args.out);
  lab::write_sample(args.out, args.sample);
  fmt::print("{}: {} frames, their ground truth in {}\n", args.out.string(),
             args.sample.scenes.size(), labels::default_label_dir(args.out).string());
  return 0;
}

int run_synth_stairs(const SynthStairsArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  const auto make = [&](int i) {
    return NamedCloud{fmt::format("stairs_{:03}", i), lab::make_stairs(i, args.stairs).cloud};
  };
  const int done = write_clouds(args.out, "synth stairs", args.count, args.threads, stop, make);
  fmt::print("{}: {} stairs\n", args.out.string(), done);
  if (stop.stop_requested()) throw Cancelled();
  return 0;
}

int run_synth_set(const SynthSetArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  const std::string task = "synth set " + args.set.name;
  return args.set.depth ? write_set_depth(args, task, stop) : write_set_clouds(args, task, stop);
}

}  // namespace planescope::app
