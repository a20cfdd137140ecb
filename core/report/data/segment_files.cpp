#include "core/report/data/segment_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/report/data/plane_files.hpp"

namespace planescope::report {

std::filesystem::path frame_folder(int frame_index) {
  return std::filesystem::path("frames") / fmt::format("{:06}", frame_index);
}

Image16 plane_image(const Frame& frame, const planes::FrameResult& result) {
  Image16 image(frame.depth.width, frame.depth.height);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    image.data[result.cloud.source[i]] =
        static_cast<std::uint16_t>(std::min(result.plane_of[i], 65535));
  return image;
}

Image16 track_image(const Frame& frame,
                    const planes::FrameResult& result,
                    std::span<const int> tracks) {
  Image16 image = plane_image(frame, result);
  for (std::uint16_t& id : image.data)
    if (id > 0) id = static_cast<std::uint16_t>(std::min(tracks[id - 1], 65535));
  return image;
}

PointSet labelled_cloud(const Frame& frame, const planes::FrameResult& result) {
  const planes::Cloud& cloud = result.cloud;
  const std::size_t n = frame.is_cloud() ? frame.cloud->points.size() : cloud.points.size();
  // World coordinates close to zero fit a float; an origin far away is written as doubles.
  const bool far_away = cloud.origin.norm() > 100;
  PointSet set;
  if (far_away) set.origin = cloud.origin;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  set.points.assign(n, Vec3f(kNan, kNan, kNan));  // what was no measurement stays none
  set.label.assign(n, 0);
  const std::uint32_t* const place_of = frame.is_cloud() ? cloud.source.data() : nullptr;
  const auto place = [place_of](std::size_t i) { return place_of ? place_of[i] : i; };
  const Vec3d shift = far_away ? Vec3d::Zero().eval() : cloud.origin;
  if (place_of || !shift.isZero(0))
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      set.points[place(i)] = (cloud.points[i].cast<double>() + shift).cast<float>();
  else
    std::ranges::transform(cloud.points, set.points.begin(),
                           [](const Vec3f& p) { return p + Vec3f::Zero(); });  // -0 becomes 0
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (const std::uint32_t voxel = result.voxels.voxel_of[i]; voxel != planes::kNoVoxel)
      set.label[place(i)] = static_cast<std::uint8_t>(result.classification.labels[voxel]);
  if (!place_of) {
    set.instance = result.plane_of;
    return set;
  }
  set.instance.assign(n, 0);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) set.instance[place(i)] = result.plane_of[i];
  return set;
}

void write_segment_files(const std::filesystem::path& dir,
                         const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::FramePlanes& found,
                         const planes::PipelineOptions& options,
                         const std::vector<std::string>& also) {
  write_file_text(dir / "timings.json", planes::timings_json(result.timings));
  write_file_text(dir / "planes.json", planes::planes_json(frame, result, found, options));
  write_plane_files(dir, also, found);
  if (!frame.is_cloud()) io::write_png(dir / "planes.png", plane_image(frame, result));
  if (!frame.is_cloud() && found.tracks)
    io::write_png(dir / "tracks.png", track_image(frame, result, *found.tracks));
  io::write_ply(dir / "cloud.ply", labelled_cloud(frame, result));
}

}  // namespace planescope::report
