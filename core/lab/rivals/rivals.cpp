// Table of the PCL and CGAL methods, and running any method by name.

#include "core/lab/rivals/rivals.hpp"

#include <algorithm>

#include "core/model/error.hpp"

namespace planescope::lab {

const std::vector<LibraryRival>& library_rivals() {
  static const std::vector<LibraryRival> rivals = {
#ifdef PLANESCOPE_RIVALS
      {"pcl-multi-plane", pcl_multi_plane, nullptr},
      {"pcl-region-growing", nullptr, pcl_region_growing},
      {"cgal-ransac", nullptr, cgal_ransac},
      {"cgal-region-growing", nullptr, cgal_region_growing},
#endif
  };
  return rivals;
}

const LibraryRival* find_library_rival(const std::string& name) {
  const auto found = std::ranges::find(library_rivals(), name, &LibraryRival::name);
  return found == library_rivals().end() ? nullptr : &*found;
}

std::vector<std::string> rival_names(bool images) {
  std::vector<std::string> names;
  for (const planes::Method method : planes::built_methods())
    if (method != planes::Method::ours) names.emplace_back(planes::to_string(method));
  for (const LibraryRival& rival : library_rivals())
    if (images || rival.on_points) names.emplace_back(rival.name);
  return names;
}

planes::FrameResult run_method(const Frame& frame,
                               const planes::PipelineOptions& options,
                               const planes::Classifier* classifier,
                               const LibraryRival* rival) {
  if (!rival) return planes::run_frame(frame, options, classifier);
  if (rival->on_pixels && frame.is_cloud())
    throw Error(std::string("method ") + rival->name +
                " supports only depth images, but this frame is a cloud");
  planes::PipelineOptions unlabeled = options;
  unlabeled.method = planes::Method::region_growing;
  planes::FrameResult result{planes::prepare_frame(frame, unlabeled, nullptr), {}, {}};
  const bool by_point = options.cloud.voxel_size_m == 0;
  planes::FoundRegions found = planes::regions_of_rival(
      result,
      rival->on_pixels ? rival->on_pixels(planes::pixel_points(frame, result))
                       : rival->on_points(result.voxels.points, by_point),
      rival->on_pixels != nullptr);
  result.segmentation = std::move(found.segmentation);
  result.plane_of = std::move(found.plane_of);
  return result;
}

}  // namespace planescope::lab
