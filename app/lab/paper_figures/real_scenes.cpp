// The paper's figure of real data: each scene once as the camera sees it, then method by method.

#include <fmt/format.h>

#include <optional>

#include "app/commands/inputs.hpp"
#include "app/lab/paper_figures/parts.hpp"
#include "render/paint.hpp"
#include "render/plane_colors.hpp"
#include "render/scenes.hpp"

namespace planescope::app::figures {
namespace {

constexpr int kCloudWidth = 960, kCloudHeight = 720;  // of clouds

/// Which frame of a recording makes a scene, and how far it reaches.
struct RealScene {
  const PaperRecording* recording = nullptr;
  std::string name;
  int frame = 0;
  double max_range_m = 1.5;
};

struct KnownScene {
  const char* recording;  // its name in assets/paper_recordings.txt
  const char* name;
  int frame = 0;
  double max_range_m = 1.5;
};
constexpr KnownScene kKnownScenes[] = {
    {"kinect_stairs", "stairs from above"},      {"entrance_stairs_cloud", "building entrance"},
    {"parcels_room", "room with parcels", 0, 4}, {"office_corner", "office corner", 0, 3},
    {"robot_lab", "robot lab", 20, 2},
};

/// Those that are known; of other recordings, each one's first frame.
std::vector<RealScene> scenes_of(std::span<const PaperRecording> recordings) {
  std::vector<RealScene> scenes;
  for (const KnownScene& known : kKnownScenes)
    for (const PaperRecording& recording : recordings)
      if (recording.name == known.recording)
        scenes.push_back({&recording, known.name, known.frame, known.max_range_m});
  if (!scenes.empty()) return scenes;
  for (const PaperRecording& recording : recordings)
    scenes.push_back({&recording, recording.name, open_inputs(recording.input)[0].frames[0],
                      recording.input.pipeline.cloud.max_range_m});
  return scenes;
}

const std::vector<Contestant>& contestants() {
  static const std::vector<Contestant> all = {
      {"ours, refined", lab::with_ours({}, "refined", "gcn")},
      {"ours, paper", lab::with_ours({}, "paper", "gcn")},
      {"RANSAC, 0.01 m", lab::with_rival({}, "ransac")},
      {"RANSAC, 0.02 m", lab::with_rival({}, "ransac", lab::kRansacCoarse)},
      {"region growing", lab::with_rival({}, "region-growing")},
  };
  return all;
}

planes::PipelineOptions scene_options(const RealScene& scene,
                                      const Contestant& contestant,
                                      const Work& work) {
  planes::PipelineOptions options = options_of(contestant.key, work);
  options.cloud.max_range_m = scene.max_range_m;
  options.gravity = scene.recording->input.pipeline.gravity;
  return options;
}

/// What is there to be segmented: the camera's image, the depth's relief, or the cloud by height.
Image8 plain_view(const LoadedFrame& loaded, const Work& work, const render::Camera& camera) {
  const Frame& frame = loaded.frame;
  if (frame.is_cloud())
    return work.renderer.render(bare(render::scene_heights(loaded.result)), camera, kCloudWidth,
                                kCloudHeight, render::Theme::light);
  const Image8 image = frame.color.empty() ? render::shaded_depth(frame) : frame.color;
  return render::enlarge(image, render::enlargement(image.width));
}

Image8 found_view(const LoadedFrame& loaded,
                  const std::vector<int>& colors,
                  const Work& work,
                  const render::Camera& camera) {
  if (!loaded.frame.is_cloud()) return render::image_overlay(loaded.frame, loaded.result, colors);
  const planes::FrameResult& result = loaded.result;
  return work.renderer.render(bare_planes(result.cloud.points, result.plane_of, colors), camera,
                              kCloudWidth, kCloudHeight, render::Theme::light);
}

/// Colors that follow those of the first method, so that the same plane looks the same.
std::vector<int> colors_after(const planes::FrameResult& result,
                              std::optional<render::ColoredPlanes>& first) {
  const render::ColoredPlanes now =
      render::color_planes(render::plane_image(result), first ? &*first : nullptr);
  if (!first) first = now;
  return now.own_colors();
}

void add_scene(lab::PaperFigure& figure, const Work& work, const RealScene& scene) {
  const std::vector<OpenInput> inputs = open_inputs(scene.recording->input);
  std::optional<render::ColoredPlanes> first;
  render::Camera camera;
  for (const Contestant& contestant : contestants()) {
    work.begin(fmt::format("{}, {}", scene.name, contestant.name));
    const LoadedFrame loaded = run_input_frame(
        inputs[0], scene.frame, scene_options(scene, contestant, work), work.network.get(), false);
    if (!first) {
      camera = render::frame_camera(loaded.result, static_cast<double>(kCloudWidth) / kCloudHeight);
      add_picture(figure, scene.name, "scene",
                  fmt::format("{}, frame {}; {} points", scene.recording->name, scene.frame,
                              loaded.result.cloud.counts.kept),
                  plain_view(loaded, work, camera));
    }
    add_picture(figure, scene.name, contestant.name, planes_text(loaded.result),
                found_view(loaded, colors_after(loaded.result, first), work, camera));
  }
}

}  // namespace

lab::PaperFigure real_scenes(const Work& work) {
  lab::PaperFigure figure;
  figure.id = "real_scenes";
  figure.title = "Real scenes, method by method";
  figure.note =
      "Each scene as the camera sees it (without a colour image: the relief of its depth, or the "
      "cloud by height), then the planes that each method finds and the share of points in none of "
      "them. A plane keeps the colour it has in the first picture. Labels of the 3D-GCN; other "
      "options as by default.";
  for (const RealScene& scene : scenes_of(work.args.recordings)) add_scene(figure, work, scene);
  return figure;
}

}  // namespace planescope::app::figures
