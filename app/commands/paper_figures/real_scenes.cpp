// The paper's figure of real data: each scene once as the camera sees it, then method by method.

#include <fmt/format.h>

#include <filesystem>

#include "app/commands/inputs.hpp"
#include "app/commands/paper_figures/parts.hpp"
#include "render/paint.hpp"
#include "render/palette.hpp"
#include "render/region_image.hpp"
#include "render/scenes.hpp"

namespace planescope::figures {
namespace {

constexpr int kWidth = 960, kHeight = 720;  // of clouds

/// A frame of a recording that is often at hand, and what it does not say of itself.
struct RealScene {
  const char* name;
  const char* path;  // below the folder of recordings
  int frame = 0;
  Vec3d gravity;
  double max_range_m = 1.5;
  std::optional<std::array<double, 4>> intrinsics;
  std::optional<double> depth_unit_m;
};
const std::vector<RealScene>& real_scenes_known() {
  static const std::vector<RealScene> scenes = {
      {"stairs from above",
       "stairs_kinect2_512x424/0000_depth.png",
       0,
       {0.047, 0.235, 0.971},
       1.5,
       {{365.3177, 365.3174, 254.685, 208.549}},
       0.001},
      {"building entrance",
       "plane_seg_clouds/anymal/ori_entrance_stair_climb/06.pcd",
       0,
       {0, 0, -1},
       1.5,
       {},
       {}},
      {"room with parcels", "felixchenfy_d4xx_640x480", 0, {-0.323, 0.844, 0.428}, 4, {}, {}},
      {"office corner",
       "realsense_sdk_bag/single_depth_color_640x480.bag",
       0,
       {0, 1, 0},
       3,
       {},
       {}},
      {"robot lab",
       "aims_slam_realsense_640x480",
       20,
       {0.175, 0.922, 0.346},
       2,
       {{383.8, 383.8, 321.7, 236.8}},
       {}},
  };
  return scenes;
}

const std::vector<Contestant>& contestants() {
  static const std::vector<Contestant> all = {
      {"ours, refined", with_ours({}, "refined", "gcn")},
      {"ours, paper", with_ours({}, "paper", "gcn")},
      {"RANSAC, 0.01 m", with_rival({}, "ransac")},
      {"RANSAC, 0.02 m", with_rival({}, "ransac", kRansacCoarse)},
      {"region growing", with_rival({}, "region-growing")},
  };
  return all;
}

InputArgs input_of(const RealScene& scene, const std::filesystem::path& data) {
  InputArgs input;
  input.inputs = {data / scene.path};
  input.frames.first = scene.frame;
  input.frames.last = scene.frame + 1;
  input.recording.intrinsics = scene.intrinsics;
  input.recording.depth_unit_m = scene.depth_unit_m;
  return input;
}

PipelineOptions scene_options(const RealScene& scene,
                              const Contestant& contestant,
                              const Work& work) {
  PipelineOptions options = options_of(contestant.key, work);
  options.cloud.max_range_m = scene.max_range_m;
  options.gravity.mode = GravityMode::fixed;
  options.gravity.direction = scene.gravity;
  return options;
}

/// What is there to be segmented: the camera's image, the depth's relief, or the cloud by height.
Image8 plain_view(const LoadedFrame& loaded, const Work& work, const Camera& camera) {
  const Frame& frame = loaded.frame;
  if (frame.is_cloud())
    return work.renderer.render(bare(scene_heights(loaded.result)), camera, kWidth, kHeight,
                                Theme::light);
  const Image8 image = frame.color.empty() ? shaded_depth(frame) : frame.color;
  return enlarge(image, enlargement(image.width));
}

Image8 found_view(const LoadedFrame& loaded,
                  const std::vector<int>& colors,
                  const Work& work,
                  const Camera& camera) {
  if (!loaded.frame.is_cloud()) return image_overlay(loaded.frame, loaded.result, colors);
  const FrameResult& result = loaded.result;
  return work.renderer.render(bare_planes(result.cloud.points, result.plane_of, colors), camera,
                              kWidth, kHeight, Theme::light);
}

/// Colours that follow those of the first method, so that the same plane looks the same.
std::vector<int> colors_after(const FrameResult& result, std::vector<ColoredPlane>& first) {
  std::vector<ColoredPlane> now;
  for (const PlaneRegion& plane : result.segmentation.planes)
    now.push_back({plane.label, plane.fit.normal,
                   plane.fit.normal.dot(plane.fit.centroid + result.cloud.origin),
                   plane.fit.centroid + result.cloud.origin, 0});
  keep_colors(first, now);
  if (first.empty()) first = now;
  std::vector<int> colors;
  for (const ColoredPlane& plane : now) colors.push_back(plane.color_id);
  return colors;
}

void add_scene(PaperFigure& figure, const Work& work, const RealScene& scene) {
  const std::vector<OpenInput> inputs = open_inputs(input_of(scene, work.args.data));
  std::vector<ColoredPlane> first;
  Camera camera;
  for (const Contestant& contestant : contestants()) {
    work.begin(fmt::format("{}, {}", scene.name, contestant.name));
    const LoadedFrame loaded = run_input_frame(
        inputs[0], scene.frame, scene_options(scene, contestant, work), work.network.get(), false);
    if (first.empty()) {
      camera = frame_camera(loaded.result, static_cast<double>(kWidth) / kHeight);
      add_picture(figure, scene.name, "scene",
                  fmt::format("{}, frame {}; {} points", inputs[0].path.filename().string(),
                              scene.frame, loaded.result.cloud.counts.kept),
                  plain_view(loaded, work, camera));
    }
    add_picture(figure, scene.name, contestant.name, planes_text(loaded.result),
                found_view(loaded, colors_after(loaded.result, first), work, camera));
  }
}

}  // namespace

PaperFigure real_scenes(const Work& work) {
  PaperFigure figure;
  figure.id = "real_scenes";
  figure.title = "Real scenes, method by method";
  figure.note =
      "Each scene as the camera sees it (without a colour image: the relief of its depth, or the "
      "cloud by height), then the planes that each method finds and the share of points in none of "
      "them. A plane keeps the colour it has in the first picture. Labels of the 3D-GCN; other "
      "options as by default.";
  if (work.args.data.empty()) return figure;
  for (const RealScene& scene : real_scenes_known())
    if (std::filesystem::exists(work.args.data / scene.path)) add_scene(figure, work, scene);
  return figure;
}

}  // namespace planescope::figures
