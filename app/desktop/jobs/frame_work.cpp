// Work on one frame for jobs: loading, processing, scoring, thumbnails and plane colors.

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/commands/inputs.hpp"
#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/page/pictures.hpp"
#include "render/palette.hpp"
#include "render/scenes.hpp"

namespace planescope::desktop {
namespace {

constexpr render::Rgba kBackground = {30, 33, 38, 255};
constexpr double kCutOff = 0.01;  // fraction of voxels on each side that are ignored as outliers

struct Range {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
  double extent() const { return high - low; }
};

Range range_of(const std::vector<Vec3f>& points, int axis) {
  std::vector<float> values;
  values.reserve(points.size());
  for (const Vec3f& point : points) values.push_back(point[axis]);
  return {render::quantile(values, kCutOff), render::quantile(values, 1 - kCutOff)};
}

/// Thumbnail of a cloud: its voxels from above in the colors of their planes, width x 3/4 width
/// pixels, with world x to the right and y up. Each pixel shows its highest voxel. The outermost
/// percent of the voxels on each side may be cut off.
Image8 cloud_thumbnail(const debug::Run& run, const render::StepLook& look, int width) {
  const planes::VoxelCloud& voxels = run.subject->prepared.voxels;
  const int height = 3 * width / 4;
  Image8 image(width, height, 3);
  const auto paint = [&](int u, int v, render::Rgba color) {
    std::uint8_t* pixel = &image.data[3 * (static_cast<std::size_t>(v) * width + u)];
    pixel[0] = color.r;
    pixel[1] = color.g;
    pixel[2] = color.b;
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) paint(u, v, kBackground);
  if (voxels.points.empty()) return image;

  const Range x = range_of(voxels.points, 0), y = range_of(voxels.points, 1);
  // At least one voxel, so that a single voxel does not cause a division by zero.
  const double least = std::max(voxels.size_m, 1e-3);
  const double scale =
      0.94 * std::min(width / std::max(x.extent(), least), height / std::max(y.extent(), least));
  const int half = std::clamp(static_cast<int>(scale * voxels.size_m / 2), 0, width / 8);  // [px]
  std::vector<float> highest(static_cast<std::size_t>(width) * height,
                             -std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < voxels.points.size(); ++i) {
    const Vec3f& point = voxels.points[i];
    const double across = width / 2.0 + scale * (point.x() - x.middle());
    const double down = height / 2.0 - scale * (point.y() - y.middle());
    if (across < 0 || across >= width || down < 0 || down >= height) continue;
    const int u = static_cast<int>(across), v = static_cast<int>(down);
    const std::int32_t plane = run.segmentation.plane_of[i];
    const render::Rgba color = plane > 0 ? look.plane_color(run.timeline.plane_of_number(plane))
                                         : render::leftover_color();
    for (int b = std::max(0, v - half); b <= std::min(height - 1, v + half); ++b)
      for (int a = std::max(0, u - half); a <= std::min(width - 1, u + half); ++a) {
        float& top = highest[static_cast<std::size_t>(b) * width + a];
        if (point.z() <= top) continue;
        top = point.z();
        paint(a, b, color);
      }
  }
  return image;
}

constexpr int kThumbnailWidth = 200;  // [px]

/// Changes whenever a weights file is rewritten, e.g. by training; empty for other classifiers.
std::string stamp_of(const std::string& classifier) {
  if (!planes::names_weights_file(classifier)) return "";
  std::error_code absent;
  return std::to_string(
      std::filesystem::last_write_time(classifier, absent).time_since_epoch().count());
}

/// The options of some sections as one text.
std::string options_key(const planes::PipelineOptions& options, bool preparing) {
  std::string key = preparing ? stamp_of(options.classifier) : "";
  if (preparing) key += options.segment.by_objective() ? "of pixels|" : "of voxels|";
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (is_about_planes(info)) continue;
    const bool segments = info.steers_segmentation() || info.section == "rivals";
    if (segments != preparing) key += info.get(options) + '|';
  }
  return key;
}

/// By plane id - 1; empty if the run's planes are not the tracked ones.
std::vector<int> track_colors(const Wanted& wanted, const debug::Run& run) {
  const MapView* map = wanted.map.get();
  if (!map || map->key != wanted.key() || map->picked != wanted.picked) return {};
  return colors_by_track(*map, run);
}

std::optional<debug::QuickScore> score_of(const debug::Run& run) {
  if (!run.subject->voxel_truth.known()) return std::nullopt;
  return debug::quick_score(run.segmentation.plane_of, run.subject->voxel_truth);
}

/// If several true planes match the same found plane, the one with the greatest IoU gets it.
TruePlanes true_planes_of(const debug::Run& run, const debug::QuickScore& score) {
  const debug::VoxelTruth& truth = run.subject->voxel_truth;
  TruePlanes true_planes;
  std::vector<std::int32_t> number_of(static_cast<std::size_t>(truth.plane_count) + 1, 0);
  std::map<int, const debug::TruthMatch*> best;  // by found plane
  for (const debug::TruthMatch& match : score.planes) {
    true_planes.ids.push_back(match.truth);
    number_of[static_cast<std::size_t>(match.truth)] =
        static_cast<std::int32_t>(true_planes.ids.size());
    const debug::TruthMatch*& of_found = best[match.found];
    if (!of_found || of_found->iou < match.iou) of_found = &match;
  }
  for (const debug::TruthMatch& match : score.planes)
    true_planes.found_of.push_back(best[match.found] == &match ? match.found : 0);
  const planes::PreparedFrame& prepared = run.subject->prepared;
  std::vector<std::int32_t> of_point;
  for (const std::uint32_t voxel : prepared.voxels.voxel_of) {
    const std::int32_t id = voxel == planes::kNoVoxel ? 0 : truth.plane[voxel];
    of_point.push_back(id > 0 ? number_of[static_cast<std::size_t>(id)] : 0);
  }
  true_planes.image = render::plane_image(prepared.cloud, of_point, true_planes.ids.size());
  return true_planes;
}

planes::FrameResult result_of(const debug::Run& run) {
  planes::FrameResult result;
  static_cast<planes::PreparedFrame&>(result) = run.subject->prepared;
  result.segmentation = run.segmentation;
  result.plane_of = run.plane_of;
  return result;
}

}  // namespace

std::shared_ptr<const planes::Classifier> FrameTools::classifier(
    const planes::PipelineOptions& options) {
  const std::lock_guard lock(mutex_);
  if (options.method != planes::Method::ours) return nullptr;
  const std::string key =
      fmt::format("{}|{}|{}|{}", options.classifier, stamp_of(options.classifier),
                  options.pca.neighbors, options.pca.max_angle_deg);
  if (key != key_) chosen_ = app::choose_classifier(options).classifier;
  key_ = key;
  return chosen_;
}

std::shared_ptr<const world::SequenceGravity> FrameTools::gravity(
    const std::shared_ptr<const io::Recording>& recording, const planes::GravityOptions& options) {
  const std::lock_guard lock(mutex_);
  if (!gravity_ || gravity_of_ != recording || gravity_by_.mode != options.mode ||
      gravity_by_.max_tilt_deg != options.max_tilt_deg)
    gravity_ = std::make_shared<world::SequenceGravity>(recording, options);
  gravity_of_ = recording;
  gravity_by_ = options;
  return gravity_;
}

Wanted wanted_of(const Document& document, int frame) {
  const OpenRecording& open = *document.current();
  return {.recording = open.recording,
          .label_dir = open.label_dir,
          .frame = frame,
          .options = document.options,
          .picked = open.picked,
          .labels_version = document.labels_version,
          .prepare_key = options_key(document.options, true),
          .segment_key = options_key(document.options, false)};
}

Wanted wanted_in(const State& state, int frame) {
  Wanted wanted = wanted_of(state.document, frame);
  if (state.map()) wanted.map = state.results.map.made;
  return wanted;
}

std::string run_key(const planes::PipelineOptions& options) {
  return options_key(options, true) + options_key(options, false);
}

Wanted with_options(Wanted wanted, const planes::PipelineOptions& options) {
  wanted.options = options;
  wanted.prepare_key = options_key(options, true);
  wanted.segment_key = options_key(options, false);
  return wanted;
}

std::shared_ptr<const debug::Subject> load_subject(const Wanted& wanted,
                                                   FrameTools& tools,
                                                   std::string* refused_labels) {
  const io::RecordingInfo& info = wanted.recording->info();
  if (!info.knows_camera())
    throw Error(info.path.string() + ": has no camera intrinsics");  // the window asks for them
  const std::shared_ptr<const planes::Classifier> classifier = tools.classifier(wanted.options);
  Frame frame = wanted.recording->frame(wanted.frame);
  planes::PipelineOptions options = wanted.options;
  options.gravity.none_where_unknown = true;
  const world::CameraPose* pose = wanted.map ? wanted.map->pose(wanted.frame) : nullptr;
  if (pose) {
    io::apply_picked_gravity(wanted.picked, frame);
    options = world::turn_to_map(frame, options, *pose, wanted.map->map);
  } else {
    tools.gravity(wanted.recording, options.gravity)->resolve(frame, wanted.picked);
  }
  const std::string hash = wanted.recording->frame_hash(wanted.frame);
  std::optional<planes::SourceTruth> truth;
  try {
    truth = labels::frame_truth(frame, wanted.label_dir, hash);
  } catch (const Error& error) {
    if (!refused_labels) throw;
    *refused_labels = error.what();
  }
  return debug::make_subject(std::move(frame), std::move(truth), options, classifier.get());
}

std::shared_ptr<const render::ColoredPlanes> ColorBook::nearest(const Wanted& wanted) const {
  constexpr int kOtherOptions = 3;  // distance in frames added for other options
  const std::lock_guard lock(mutex_);
  if (recording_ != wanted.recording) return nullptr;
  const std::string key = wanted.key();
  const FrameColors* nearest = nullptr;
  int least = std::numeric_limits<int>::max();
  for (const auto& [frame, colors] : of_frame_) {
    const int far = std::abs(frame - wanted.frame) + (colors.key == key ? 0 : kOtherOptions);
    if (far < least) nearest = &colors;
    least = std::min(least, far);
  }
  return nearest ? nearest->planes : nullptr;
}

FrameColors ColorBook::colors(const Wanted& wanted,
                              const debug::Run& run,
                              const render::ColoredPlanes* like) const {
  render::PlaneImage image = render::plane_image(run);
  std::vector<int> of_tracks = track_colors(wanted, run);
  FrameColors colors{nullptr, wanted.key(), !of_tracks.empty()};
  render::ColoredPlanes colored;
  if (colors.of_tracks) {
    colored.colors = render::settle_colors(image, std::move(of_tracks));
    colored.unseen.assign(colored.colors.size(), 0);
    colored.image = std::move(image);
  } else {
    const auto near = like ? nullptr : nearest(wanted);
    colored = render::color_planes(std::move(image), like ? like : near.get());
  }
  colors.planes = std::make_shared<const render::ColoredPlanes>(std::move(colored));
  return colors;
}

void ColorBook::keep(const Wanted& wanted, const FrameColors& colors) {
  const std::lock_guard lock(mutex_);
  if (recording_ != wanted.recording) of_frame_.clear();
  recording_ = wanted.recording;
  of_frame_[wanted.frame] = colors;
}

std::shared_ptr<const RunView> view_run(std::shared_ptr<const debug::Run> run,
                                        const render::Home& home,
                                        const Wanted& wanted,
                                        FrameColors colors) {
  auto view = std::make_shared<RunView>();
  view->histograms = debug::histograms_of(*run);
  view->summary = debug::summary_of(*run);
  view->score = score_of(*run);
  if (view->score) view->truth = true_planes_of(*run, *view->score);
  view->home = home;
  view->outlines = outlines_of_run(*run);
  view->map = wanted.map;
  view->colors = std::move(colors);
  if (wanted.map)
    view->map_lines =
        std::make_shared<const std::vector<render::DrawLines>>(map_lines(*wanted.map, *run));
  view->run = std::move(run);
  return view;
}

render::Home home_of(const debug::Run& run) {
  return render::home_of(run.subject->prepared, run.segmentation);
}

Thumbnail thumbnail_of(const Wanted& wanted,
                       FrameTools& tools,
                       ColorBook& book,
                       const render::ColoredPlanes* like) {
  Thumbnail thumbnail;
  thumbnail.ready = true;
  try {
    const auto run = debug::make_run(load_subject(wanted, tools), wanted.options);
    render::StepLook look;
    look.step = run->steps();
    look.color_by = render::ColorBy::planes;
    look.show_current = false;
    thumbnail.colors = book.colors(wanted, *run, like);
    book.keep(wanted, thumbnail.colors);
    look.color_of_plane = render::trace_colors(*run, thumbnail.colors.planes->own_colors());
    thumbnail.image =
        run->subject->frame.depth.empty()
            ? cloud_thumbnail(*run, look, kThumbnailWidth)
            : report::shrink(render::image_step(*run, look, render::Backdrop::color, 0.6),
                             kThumbnailWidth);
    thumbnail.planes = static_cast<int>(run->segmentation.planes.size());
    thumbnail.score = score_of(*run);
  } catch (const std::exception& error) {
    thumbnail.refusal = message_of(error);
  }
  return thumbnail;
}

Thumbnail picture_of(const Wanted& wanted) {
  Thumbnail thumbnail;
  thumbnail.ready = true;
  thumbnail.planes = -1;
  try {
    const Frame frame = wanted.recording->frame(wanted.frame);
    if (frame.color.channels == 3)
      thumbnail.image = report::shrink(frame.color, kThumbnailWidth);
    else if (!frame.depth.empty())
      thumbnail.image = report::shrink(render::shaded_depth(frame), kThumbnailWidth);
  } catch (const std::exception& error) {
    thumbnail.refusal = message_of(error);
  }
  return thumbnail;
}

// ---- Analysis of a run's planes ----------------------------------------------------------------

std::shared_ptr<const render::PlaneScene> outlines_of_run(const debug::Run& run) {
  const planes::FrameResult result = result_of(run);
  auto scene = std::make_shared<render::PlaneScene>();
  scene->origin = result.cloud.origin;
  try {
    const double cell_m = planes::cell_size_m(result.voxels.size_m);
    scene->shapes = render::plane_shapes(planes::outlines_of(run.subject->frame, result, cell_m),
                                         result.cloud.origin);
  } catch (const Error&) {
    return nullptr;  // planes_of_run() reports the reason
  }
  return scene;
}

std::shared_ptr<const RunPlanes> planes_of_run(const std::shared_ptr<const RunView>& view,
                                               const planes::PipelineOptions& options) {
  const debug::Run& run = *view->run;
  const planes::FrameResult result = result_of(run);
  planes::PipelineOptions asked = run.options;
  asked.foot = options.foot;
  asked.stairs = options.stairs;
  auto made = std::make_shared<RunPlanes>();
  made->of = view;
  made->key = planes_key(options);
  made->found = planes::analyze_planes(run.subject->frame, result, asked);
  made->scene = std::make_shared<const render::PlaneScene>(
      render::plane_scene(result.segmentation.planes, made->found.outlines, made->found.footholds,
                          made->found.stairs, result.cloud.origin));
  return made;
}

bool is_about_planes(const planes::OptionInfo& info) {
  return info.section == "foot" || info.section == "stairs";
}

std::string planes_key(const planes::PipelineOptions& options) {
  std::string key;
  for (const planes::OptionInfo& info : planes::option_table())
    if (is_about_planes(info)) key += info.get(options) + '|';
  return key;
}

}  // namespace planescope::desktop
