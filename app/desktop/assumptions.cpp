#include "app/desktop/assumptions.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/io/folder/camera_files.hpp"

namespace planescope::desktop {
namespace {

constexpr double kFarShare = 0.1;         // of the measured points
constexpr double kLeastConfidence = 0.5;  // of estimated gravity
constexpr double kPointsPerEdge = 2.5;    // along a voxel: fewer are not too coarse

/// The next range worth a try; 0: none.
double wider_range(double range_m) {
  for (const double wider : {4.0, 10.0})
    if (range_m < 0.99 * wider) return wider;
  return 0;
}

/// Distance between neighboring points, as if each voxel held a square of surface.
double spacing_m(const debug::Subject& subject) {
  const auto points = static_cast<double>(subject.prepared.cloud.points.size());
  const auto voxels = static_cast<double>(subject.voxel_count());
  return voxels > 0 ? subject.prepared.voxels.size_m / std::sqrt(points / voxels) : 0;
}

/// The finest of the usual sizes that still holds some points.
double voxel_for(double spacing_m) {
  for (const double size : {0.002, 0.005, 0.01})
    if (size > kPointsPerEdge * spacing_m) return size;
  return 0.02;
}

}  // namespace

std::vector<Assumption> assumptions_of(const State& state) {
  const RunView* view = state.run_view();
  const OpenRecording* open = state.document.current();
  if (!view || !open || open->path == state.view.assumptions_hidden) return {};
  const debug::Subject& subject = *view->run->subject;
  const planes::PipelineOptions& options = view->run->options;
  const io::RecordingInfo& info = open->recording->info();
  std::vector<Assumption> all;
  if (info.intrinsics_source.starts_with("assumed"))
    all.push_back({fmt::format("Intrinsics {}", info.intrinsics_source), "edit",
                   "The recording has no intrinsics. Wrong ones bend planes and change sizes.",
                   "intrinsics.edit", ""});
  else if (const std::string camera = io::nominal_camera(info.intrinsics); !camera.empty())
    all.push_back({fmt::format("Intrinsics nominal ({})", camera), "edit",
                   "Each camera's own values differ by a percent or two.", "intrinsics.edit", ""});
  if (!subject.frame.is_cloud() && info.depth_unit_source.starts_with("assumed"))
    all.push_back({fmt::format("Depth unit {:g} mm assumed", 1000 * info.depth_unit_m), "edit",
                   "The recording has no depth unit. A wrong one scales all lengths.",
                   "intrinsics.edit", ""});
  const double beyond = view->summary.share(view->summary.beyond);
  const double wider = wider_range(options.cloud.max_range_m);
  if (beyond > kFarShare && wider > 0)
    all.push_back({fmt::format("{:.0f} % beyond {:g} m", 100 * beyond, options.cloud.max_range_m),
                   fmt::format("show {:g} m", wider),
                   "Points beyond the option max_range_m are not segmented.", "option.set",
                   fmt::format("max_range_m={:g}", wider)});
  const Gravity& gravity = subject.prepared.gravity;
  if (gravity.known() && gravity.confidence < kLeastConfidence)
    all.push_back({fmt::format("Gravity uncertain ({:.0f} %)", 100 * gravity.confidence),
                   "click the floor",
                   "Gravity was estimated from the scene. A click on a floor or a wall settles it.",
                   "gravity.click.floor", ""});
  if (subject.frame.is_cloud()) {
    const double size = subject.prepared.voxels.size_m, spacing = spacing_m(subject);
    const double finer = voxel_for(spacing);
    if (size > kPointsPerEdge * spacing && finer < 0.99 * size)
      all.push_back(
          {fmt::format("Voxel {:g} mm, points every {:.2g} mm", 1000 * size, 1000 * spacing),
           fmt::format("use {:g} mm", 1000 * finer),
           "Voxels much coarser than the points hide small planes.", "option.set",
           fmt::format("voxel_size_m={:g}", finer)});
  }
  if (info.color_note.starts_with("assumed aligned") && subject.frame.color.channels == 3)
    all.push_back({"Color assumed aligned", "check",
                   "Color and depth have the same size, and nothing says that they are aligned. "
                   "Edges of depth over color show whether they are.",
                   "image.edges", ""});
  return all;
}

}  // namespace planescope::desktop
