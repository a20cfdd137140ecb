#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/lab/synthetic/sample_folder.hpp"

namespace planescope::lab {

struct SampleOptions {
  std::uint64_t seed = 1;
  std::vector<std::string> scenes = {"stairs", "kerb", "boxes"};  // one frame each; scene_names()
  int width = 640, height = 480;
  bool noise = true;     // false: exact depth, rounded to counts
  bool color = true;     // false: depth only
  bool gravity = false;  // also state the true gravity in planescope.json
};

/// Frame `index` of the sample, and its exact ground truth.
SampleFrame make_sample_frame(const SampleOptions& options, std::size_t index);

/// Writes a folder recording (depth/, color/, planescope.json) and, beside it in
/// default_label_dir(dir), its exact ground truth. The same options give the same pixels and the
/// same JSON bytes on every machine. Overwrites an earlier sample; throws Error, before anything is
/// written, where `dir` holds anything else, on unknown scenes and on impossible sizes.
void write_sample(const std::filesystem::path& dir, const SampleOptions& options = {});

}  // namespace planescope::lab
