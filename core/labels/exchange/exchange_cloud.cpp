#include "core/io/cloud_files/cloud_file.hpp"
#include "core/labels/exchange/exchange_files.hpp"

namespace planescope::labels {
namespace {

PointSet point_set_of(const LabelledPoints& points) {
  PointSet set;
  set.points = points.points;
  set.rgb = points.rgb;
  set.label = points.label;
  set.instance = points.instance;
  return set;
}

std::vector<io::IntField> pixel_fields_of(const LabelledPoints& points) {
  if (points.pixel.empty()) return {};
  io::IntField u{"u", {}}, v{"v", {}};
  for (const DepthPixel& pixel : points.pixel) {
    u.values.push_back(pixel.u);
    v.values.push_back(pixel.v);
  }
  return {std::move(u), std::move(v)};
}

}  // namespace

FileBytes labelled_ply_bytes(const LabelledPoints& points) {
  return io::ply_bytes(point_set_of(points), pixel_fields_of(points));
}

FileBytes labelled_pcd_bytes(const LabelledPoints& points) {
  return io::pcd_bytes(point_set_of(points), pixel_fields_of(points));
}

LabelledPoints read_labelled_cloud(const std::filesystem::path& path) {
  // label and instance exactly as in the file: PointSet's are clamped to what fits.
  io::CloudExtras extras{{"label", "instance", "u", "v"}, {}};
  PointSet set = io::read_cloud_file(path, &extras);
  const std::string where = path.string();
  if (extras.values[1].empty() && !set.points.empty())
    throw Error(where + ": its points have no field \"instance\", expected plane ids there");
  LabelledPoints points;
  points.label = classes_of(extras.values[0], where);
  points.instance = instances_of(extras.values[1], where);
  const auto u = whole_numbers<std::uint16_t>(extras.values[2], 0, 65535, where + ": u");
  const auto v = whole_numbers<std::uint16_t>(extras.values[3], 0, 65535, where + ": v");
  if (!u.empty() && !v.empty())
    for (std::size_t i = 0; i < u.size(); ++i) points.pixel.push_back({u[i], v[i]});
  points.rgb = std::move(set.rgb);
  points.points = std::move(set.points);
  const Vec3f origin = set.origin.cast<float>();
  for (Vec3f& point : points.points) point += origin;
  return points;
}

}  // namespace planescope::labels
