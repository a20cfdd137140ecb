#include "core/lab/synthetic/sample.hpp"

#include "core/lab/synthetic/counter_random.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/model/error.hpp"

namespace planescope::lab {
namespace {

constexpr int kMinSide = 16, kMaxSide = 8192;
constexpr std::size_t kMaxFrames = 10000;

void check_options(const SampleOptions& options) {
  if (options.scenes.empty() || options.scenes.size() > kMaxFrames) {
    throw Error("synth sample: " + std::to_string(options.scenes.size()) +
                " scenes, expected 1 to " + std::to_string(kMaxFrames));
  }
  for (const std::string& scene : options.scenes) make_scene(scene, options.seed);
  for (const int side : {options.width, options.height}) {
    if (side < kMinSide || side > kMaxSide) {
      throw Error("synth sample: " + std::to_string(side) + " pixels, expected " +
                  std::to_string(kMinSide) + " to " + std::to_string(kMaxSide));
    }
  }
}

}  // namespace

SampleFrame make_sample_frame(const SampleOptions& options, std::size_t index) {
  D435Model model;
  model.intrinsics = d435_intrinsics(options.width, options.height);
  model.noise = options.noise;
  model.color = options.color;
  const std::uint64_t seed = random_bits(options.seed, 0, index);
  const Scene scene = make_scene(options.scenes.at(index), seed);
  SampleFrame sample;
  sample.frame = render_scene(scene, scene.camera, model, seed, &sample.truth);
  sample.scene = scene.name;
  return sample;
}

void write_sample(const std::filesystem::path& dir, const SampleOptions& options) {
  check_options(options);
  const SampleFolder folder{"planescope synth sample", options.seed, options.scenes.size(),
                            options.color, options.gravity};
  write_sample_folder(dir, folder, [&](std::size_t i) { return make_sample_frame(options, i); });
}

}  // namespace planescope::lab
