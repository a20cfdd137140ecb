#include "app/commands/synth.hpp"

#include <fmt/format.h>

#include <atomic>

#include "app/output.hpp"
#include "app/progress.hpp"
#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/labels/label_files.hpp"
#include "core/recording/cloud_file.hpp"

namespace planescope {

int run_synth_sample(const SynthSampleArgs& args) {
  check_output_dir(args.out);
  write_sample(args.out, args.sample);
  fmt::print("{}: {} frames, their ground truth in {}\n", args.out.string(),
             args.sample.scenes.size(), default_label_dir(args.out).string());
  return 0;
}

int run_synth_stairs(const SynthStairsArgs& args, std::stop_token stop) {
  check_output_dir(args.out);
  std::error_code failed;
  std::filesystem::create_directories(args.out, failed);
  if (failed) throw Error("output " + args.out.string() + ": " + failed.message());

  std::atomic<int> done = 0;
  {
    Progress progress("synth stairs", args.count);
    const auto make = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) {
        const Stairs stairs = make_stairs(static_cast<int>(i), args.stairs);
        write_ply(args.out / fmt::format("stairs_{:03}.ply", i), stairs.cloud);
        ++done;
        if (begin == 0) progress.show(done, "");  // one thread speaks for all
      }
    };
    parallel_for(static_cast<std::size_t>(args.count), args.threads, make, 1);
  }
  fmt::print("{}: {} stairs\n", args.out.string(), done.load());
  if (stop.stop_requested()) throw Cancelled();
  return 0;
}

}  // namespace planescope
