// Options, segmenter and results of the public library.

#include <fmt/format.h>

#include <limits>
#include <span>
#include <utility>

#include "core/planes/classify/gcn.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/data/segment_files.hpp"
#include "library/data.hpp"

extern "C" const unsigned char planescope_asset_classifier_safetensors[];
extern "C" const unsigned char planescope_asset_classifier_safetensors_end[];

namespace planescope::v0 {
using detail::Access;
using detail::guarded;
using detail::ResultData;
using detail::vec3;

Options::Options(const std::string& profile) : data_(std::make_unique<Data>()) {
  guarded([&] { planes::set_option(data_->options, "profile", profile); });
}
Options::Options(const Options& other) : data_(std::make_unique<Data>(*other.data_)) {}
Options& Options::operator=(const Options& other) {
  *data_ = *other.data_;
  return *this;
}
Options::~Options() = default;

Options& Options::set(const std::string& name, const std::string& value) {
  guarded([&] {
    planes::set_option(data_->options, name, value);
    // Crop clouds only on request.
    if (name == "range_for_clouds") data_->crop_is_set = true;
    if (name == "max_range_m" && !data_->crop_is_set) data_->options.cloud.range_for_clouds = true;
  });
  return *this;
}

Options& Options::set(const std::string& name, double value) {
  return set(name, fmt::format("{}", value));
}

std::string Options::get(const std::string& name) const {
  return guarded([&] { return planes::find_option(name).get(data_->options); });
}

std::vector<OptionInfo> Options::all() {
  std::vector<OptionInfo> infos;
  for (const planes::OptionInfo& info : planes::option_table())
    infos.push_back({info.name, info.unit, info.meaning, info.section,
                     planes::default_value(info, planes::Profile::paper),
                     planes::default_value(info, planes::Profile::refined),
                     static_cast<OptionKind>(info.kind), info.range.min, info.range.max,
                     info.range.min_excluded, info.choices});
  return infos;
}

namespace {

static_assert(static_cast<int>(Label::v) == static_cast<int>(::planescope::Label::v));
static_assert(static_cast<int>(OptionKind::text) == static_cast<int>(planes::OptionKind::text));

planes::ChosenClassifier choose(const planes::PipelineOptions& options) {
  if (options.classifier == "truth")
    throw Error("classifier 'truth' is for recordings with labels; expected gcn, pca, or a file");
  if (options.classifier != "gcn") return planes::make_classifier(options, {});
  const std::span bytes(planescope_asset_classifier_safetensors,
                        planescope_asset_classifier_safetensors_end);
  return {planes::make_gcn_classifier(planes::read_weights(bytes, "classifier.safetensors"), "gcn"),
          std::nullopt};
}

/// Copies core's results, by point of the cloud, to pixels or to points in the caller's order.
void spread_out(ResultData& data, std::size_t size) {
  const planes::FrameResult& result = data.result;
  data.plane_of.assign(size, 0);
  data.label_of.assign(size, Label::unknown);
  for (std::size_t i = 0; i < result.cloud.source.size(); ++i) {
    const std::uint32_t place = result.cloud.source[i];
    data.plane_of[place] = result.plane_of[i];
    if (const std::uint32_t voxel = result.voxels.voxel_of[i]; voxel != planes::kNoVoxel)
      data.label_of[place] = static_cast<Label>(result.classification.labels[voxel]);
  }
}

Outline::Ring ring(const planes::PolygonRing& from) {
  Outline::Ring result;
  for (const Vec2d& p : from) result.push_back({p.x(), p.y()});
  return result;
}

std::vector<Outline::Ring> rings(const std::vector<planes::PolygonRing>& from) {
  std::vector<Outline::Ring> result;
  for (const planes::PolygonRing& one : from) result.push_back(ring(one));
  return result;
}

Outline outline_of(const planes::Outline& from) {
  Outline outline;
  outline.origin = vec3(from.origin);
  outline.u = vec3(from.basis.u);
  outline.v = vec3(from.basis.v);
  outline.area_m2 = from.area_m2;
  for (const planes::Outline::Part& part : from.parts)
    outline.parts.push_back({ring(part.outer), rings(part.holes), rings(part.unknown)});
  return outline;
}

Plane make_plane(const planes::FramePlanes& found, std::size_t i) {
  const planes::PlaneSummary& summary = found.summaries[i];
  Plane plane;
  plane.id = summary.id;
  plane.label = static_cast<Label>(summary.label);
  plane.normal = vec3(summary.normal);
  plane.centroid = vec3(summary.centroid);
  plane.offset_m = summary.offset_m;
  plane.tilt_deg = summary.tilt_deg;
  plane.points = summary.points;
  plane.voxels = summary.voxels;
  plane.rms_m = summary.rms_m;
  plane.area_m2 = summary.area_m2;
  plane.margin = summary.margin;
  plane.undecided = summary.undecided;
  for (const Vec3d& corner : summary.hull) plane.hull.push_back(vec3(corner));
  plane.outline = outline_of(found.outlines[i]);
  plane.height_m = found.stairs.height_m[i];
  plane.steppable = found.footholds[i].steppable;
  plane.why_not = found.footholds[i].why_not;
  return plane;
}

}  // namespace

Result detail::make_result(const Frame& frame,
                           const planes::PipelineOptions& options,
                           planes::FrameResult&& found) {
  auto data = std::make_shared<ResultData>(frame, options, std::move(found));
  const ::planescope::Gravity& gravity = data->result.gravity;
  data->gravity = {vec3(gravity.direction), to_string(gravity.source), gravity.confidence};
  spread_out(*data, frame.size());
  return Access::result(std::move(data));
}

Segmenter::Segmenter(const Options& options, int threads) {
  guarded([&] {
    if (threads < 1) throw Error(fmt::format("threads: {}; expected 1 or more", threads));
    auto data = std::make_shared<detail::SegmenterData>();
    data->options = Access::options(options);
    data->options.threads = threads;
    data->chosen = choose(data->options);
    data_ = std::move(data);
  });
}

Result Segmenter::segment(const Frame& frame) const {
  return guarded([&] {
    return detail::make_result(
        frame, data_->options,
        planes::run_frame(Access::frame(frame), data_->options, data_->chosen.classifier.get()));
  });
}

Trace Segmenter::trace(const Frame& frame) const {
  return guarded([&] {
    if (data_->options.method != planes::Method::ours)
      throw Error(fmt::format("method {} does not support traces; expected ours",
                              planes::to_string(data_->options.method)));
    const auto subject = debug::make_subject(Access::frame(frame), std::nullopt, data_->options,
                                             data_->chosen.classifier.get());
    return Access::trace(std::make_shared<const detail::TraceData>(
        detail::TraceData{frame, debug::make_run(subject, data_->options)}));
  });
}

Result Trace::result() const {
  return guarded([&] {
    const debug::Run& run = *data_->run;
    return detail::make_result(data_->frame, run.options,
                               {run.subject->prepared, run.segmentation, run.plane_of});
  });
}

void ResultData::find_planes() const {
  std::call_once(once, [this] {
    planes::FramePlanes all = planes::analyze_planes(Access::frame(frame), result, options);
    std::vector<Plane> made;
    for (std::size_t i = 0; i < all.summaries.size(); ++i) made.push_back(make_plane(all, i));
    found = std::move(all);
    planes = std::move(made);
  });
}

const Frame& Result::frame() const& { return data_->frame; }
Frame Result::frame() && { return data_->frame; }

std::vector<Plane> Result::planes() && { return std::as_const(*this).planes(); }

const std::vector<Plane>& Result::planes() const& {
  return *guarded([&] {
    data_->find_planes();
    return &data_->planes;
  });
}

View<std::int32_t> Result::plane_of() const& {
  return {data_->plane_of.data(), data_->plane_of.size()};
}

View<Label> Result::label_of() const& { return {data_->label_of.data(), data_->label_of.size()}; }

std::vector<Vec3> Result::points() const {
  return guarded([&] {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const planes::Cloud& cloud = data_->result.cloud;
    std::vector<Vec3> points(data_->plane_of.size(), Vec3{kNan, kNan, kNan});
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      points[cloud.source[i]] = vec3(Vec3d(cloud.origin + cloud.points[i].cast<double>()));
    return points;
  });
}

Mesh Result::mesh(int id) const {
  return guarded([&] {
    data_->find_planes();
    const std::vector<planes::Outline>& outlines = data_->found.outlines;
    if (id < 1 || id > static_cast<int>(outlines.size()))
      throw Error(fmt::format("plane {} is out of range; expected 1 to {}", id, outlines.size()));
    const planes::Mesh found = planes::mesh_of(outlines[static_cast<std::size_t>(id) - 1]);
    Mesh mesh;
    for (const Vec3d& vertex : found.vertices) mesh.vertices.push_back(vec3(vertex));
    mesh.triangles = found.triangles;
    return mesh;
  });
}

const Gravity& Result::gravity() const& { return data_->gravity; }
Gravity Result::gravity() && { return data_->gravity; }

Transform Result::T_world_sensor() const {
  return detail::transform(data_->result.cloud.T_world_sensor);
}

Counts Result::counts() const {
  const planes::CloudCounts& counts = data_->result.cloud.counts;
  return {counts.pixels,
          counts.no_measurement,
          counts.invalid,
          counts.beyond_range,
          counts.outside_cube,
          counts.kept,
          data_->result.voxels.points.size()};
}

Timings Result::timings() const {
  const planes::FrameTimings& timings = data_->result.timings;
  return {timings.cloud_ms, timings.t_d_ms, timings.t_c_ms, timings.t_b_ms, timings.t_s_ms};
}

std::string Result::json() const {
  return guarded([&] {
    data_->find_planes();
    return planes::planes_json(Access::frame(data_->frame), data_->result, data_->found,
                               data_->options);
  });
}

std::string Result::text(const std::string& format) const {
  return guarded([&] {
    data_->find_planes();
    std::string known;
    for (const report::PlaneFormat& one : report::plane_formats()) {
      if (one.name == format) return one.text(data_->found);
      known += (known.empty() ? "" : ", ") + std::string(one.name);
    }
    throw Error(fmt::format("unknown format '{}'; expected one of {}", format, known));
  });
}

}  // namespace planescope::v0
