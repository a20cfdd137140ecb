#include "core/report/data/segment_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/data/frame_json.hpp"
#include "core/report/data/plane_files.hpp"
#include "core/report/data/stairs_json.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Pose& pose) {
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r) {
    Json row = Json::array();
    for (int c = 0; c < 4; ++c) row.push_back(rounded(pose.matrix()(r, c)));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json options_json(const planes::PipelineOptions& options) {
  Json json = Json::object();
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (!info.matters(options)) continue;
    const std::string text = info.get(options);
    if (text == "on" || text == "off") {
      json[info.name] = text == "on";
      continue;
    }
    const Json value = Json::parse(text, nullptr, false);
    if (value.is_number())
      json[info.name] = value;
    else
      json[info.name] = text;
  }
  return json;
}

/// What our own steps count.
void add_steps(const planes::SegmentCounts& segment, Json& json) {
  json["nodes_visited"] = segment.nodes_visited;
  for (const planes::Case c :
       {planes::Case::I, planes::Case::II, planes::Case::III, planes::Case::IV})
    json["nodes_case_" + std::string(planes::to_string(c))] =
        segment.nodes_per_case[static_cast<std::size_t>(c)];
  json["candidates"] = segment.candidates;
  json["merges"] = segment.merges;
  json["leftovers"] = segment.leftovers;
  json["assigned"] = segment.assigned;
}

Json counts_json(const planes::FrameResult& result, bool ours) {
  const planes::CloudCounts& cloud = result.cloud.counts;
  const planes::SegmentCounts& segment = result.segmentation.counts;
  Json json;
  json["pixels"] = cloud.pixels;
  json["no_measurement"] = cloud.no_measurement;
  json["invalid"] = cloud.invalid;
  json["beyond_range"] = cloud.beyond_range;
  json["outside_cube"] = cloud.outside_cube;
  json["kept"] = cloud.kept;
  json["voxels"] = result.voxels.points.size();
  if (ours) add_steps(segment, json);
  json["unassigned"] = segment.unassigned;
  return json;
}

Json ring_json(const planes::Outline& outline, const planes::PolygonRing& ring) {
  Json corners = Json::array();
  for (const Vec2d& corner : ring) corners.push_back(vector_json(outline.world(corner)));
  return corners;
}

Json rings_json(const planes::Outline& outline, const std::vector<planes::PolygonRing>& rings) {
  Json all = Json::array();
  for (const planes::PolygonRing& ring : rings) all.push_back(ring_json(outline, ring));
  return all;
}

Json outline_json(const planes::Outline& outline) {
  Json parts = Json::array();
  for (const planes::Outline::Part& part : outline.parts)
    parts.push_back({{"outer", ring_json(outline, part.outer)},
                     {"holes", rings_json(outline, part.holes)},
                     {"unknown", rings_json(outline, part.unknown)}});
  return parts;
}

Json surface_json(const planes::Surface& surface) {
  Json json;
  json["slope_deg"] = std::isnan(surface.slope_deg) ? Json() : Json(rounded(surface.slope_deg));
  json["rough_rms_m"] = rounded(surface.rough_rms_m);
  json["rough_step_m"] = rounded(surface.rough_step_m);
  json["support"] = rounded(surface.support);
  json["best_place"] = vector_json(surface.best_place);
  json["clearance_m"] = rounded(surface.clearance_m);
  return json;
}

Json certainty_json(const planes::Certainty& certainty, const Vec3d& centroid) {
  Json json;
  json["sigma_m"] = rounded(certainty.sigma_m);
  json["eigenvalues_m2"] = vector_json(certainty.eigenvalues_m2);
  json["axes"] = {vector_json(certainty.axes[0]), vector_json(certainty.axes[1])};
  json["tilt_sigma_deg"] = Json::array();
  for (const double sigma_rad : certainty.sigma_tilt_rad)
    json["tilt_sigma_deg"].push_back(rounded(sigma_rad * 180 / std::numbers::pi));
  json["offset_sigma_m"] = rounded(certainty.sigma_offset_m);
  const Mat3d covariance = certainty.covariance(centroid);
  json["covariance"] = Json::array();
  for (int row = 0; row < 3; ++row) {
    // Not rounded to a nanometre: variances of good planes are smaller.
    json["covariance"].push_back({covariance(row, 0), covariance(row, 1), covariance(row, 2)});
  }
  return json;
}

Json foot_json(const planes::Foothold& foothold, const planes::Outline& outline) {
  Json json;
  json["steppable"] = foothold.steppable;
  json["why_not"] = foothold.why_not.empty() ? Json() : Json(foothold.why_not);
  json["area_m2"] = rounded(foothold.space->area_m2);
  json["area"] = Json::array();
  for (const planes::Polygon& polygon : foothold.space->area)
    json["area"].push_back({{"outer", ring_json(outline, polygon.outer)},
                            {"holes", rings_json(outline, polygon.holes)}});
  json["pieces"] = rings_json(outline, foothold.space->pieces);
  return json;
}

// The noise that was measured, and how far off a plane points may lie, one meter from the sensor.
Json noise_json(const planes::NoiseModel& noise) {
  Json json;
  json["estimated"] = noise.estimated;
  json["by_range"] = noise.by_range;
  json["sigma_at_1m_m"] = rounded(noise.sigma(1));
  json["tau_at_1m_m"] = rounded(noise.tau(1));
  return json;
}

// One line per field, but vectors, hull corners and matrix rows on one line each.
void print(std::string& out, const Json& json, const std::string& indent) {
  const bool has_parts = json.is_structured() && !json.empty();
  const bool is_row =
      json.is_array() && (json.empty() || std::none_of(json.begin(), json.end(), [](const Json& j) {
                            return j.is_structured();
                          }));
  if (!has_parts || is_row) {
    out += json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const std::string inner = indent + "  ";
  const char* separator = "\n";
  out += json.is_object() ? '{' : '[';
  for (const auto& [key, value] : json.items()) {
    out += separator + inner;
    if (json.is_object()) out += Json(key).dump() + ": ";
    print(out, value, inner);
    separator = ",\n";
  }
  out += "\n" + indent + (json.is_object() ? '}' : ']');
}

std::string printed(const Json& json) {
  std::string text;
  print(text, json, "");
  return text + "\n";
}

}  // namespace

std::filesystem::path frame_folder(int frame_index) {
  return std::filesystem::path("frames") / fmt::format("{:06}", frame_index);
}

std::string planes_json(const Frame& frame,
                        const planes::FrameResult& result,
                        const FramePlanes& found,
                        const planes::PipelineOptions& options) {
  Json json;
  json["schema"] = "planescope.planes/4";
  json["frame"] = {
      {"index", frame.index}, {"name", frame.name}, {"timestamp_s", frame.timestamp_s}};
  json["T_world_camera"] = to_json(result.cloud.T_world_sensor);
  json["gravity"] = gravity_json(result.gravity);
  json["options"] = options_json(options);
  const bool ours = options.method == planes::Method::ours;
  json["counts"] = counts_json(result, ours);
  if (ours) json["noise"] = noise_json(result.segmentation.noise);
  json["planes"] = Json::array();
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const PlaneSummary& s = found.summaries[k];
    const planes::Outline& outline = found.outlines[k];
    const planes::Foothold& foothold = found.footholds[k];
    Json plane;
    plane["id"] = s.id;
    if (found.tracks) plane["track"] = (*found.tracks)[k];
    plane["label"] = to_string(s.label);
    plane["normal"] = vector_json(s.normal);
    plane["centroid"] = vector_json(s.centroid);
    plane["offset_m"] = rounded(s.offset_m);
    plane["points"] = s.points;
    plane["voxels"] = s.voxels;
    plane["rms_m"] = rounded(s.rms_m);
    plane["area_m2"] = rounded(s.area_m2);
    plane["margin"] = std::isfinite(s.margin) ? Json(rounded(s.margin)) : Json();
    plane["undecided"] = s.undecided;
    plane["hull"] = Json::array();
    for (const Vec3d& corner : s.hull) plane["hull"].push_back(vector_json(corner));
    plane["outline"] = outline_json(outline);
    plane["outline_area_m2"] = rounded(outline.area_m2);
    const double height_m = found.stairs.height_m[k];
    plane["height_m"] = std::isnan(height_m) ? Json() : Json(rounded(height_m));
    plane["surface"] = surface_json(foothold.surface);
    plane["certainty"] = certainty_json(foothold.certainty, s.centroid);
    if (foothold.space) plane["foot"] = foot_json(foothold, outline);
    json["planes"].push_back(std::move(plane));
  }
  add_stairs(found.stairs, json);
  if (!result.from_cloud && ours) {
    json["minor_planes"] = Json::array();
    for (const planes::PlaneRegion& minor : result.segmentation.minor)
      json["minor_planes"].push_back(
          {{"label", to_string(minor.label)},
           {"normal", vector_json(minor.fit.normal)},
           {"centroid", vector_json(Vec3d(result.cloud.origin + minor.fit.centroid))},
           {"voxels", minor.points},
           {"rms_m", rounded(minor.fit.rms_m())}});
  }
  return printed(json);
}

std::string timings_json(const planes::FrameTimings& t) {
  Json json;
  json["schema"] = "planescope.timings/1";
  json["load_ms"] = t.load_ms;
  json["cloud_ms"] = t.cloud_ms;
  json["t_d_ms"] = t.t_d_ms;
  json["t_c_ms"] = t.t_c_ms;
  json["t_b_ms"] = t.t_b_ms;
  json["t_s_ms"] = t.t_s_ms;
  json["total_ms"] = planes::total_ms(t);
  return printed(json);
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
                         const FramePlanes& found,
                         const planes::PipelineOptions& options,
                         const std::vector<std::string>& also) {
  write_file_text(dir / "timings.json", timings_json(result.timings));
  write_file_text(dir / "planes.json", planes_json(frame, result, found, options));
  write_plane_files(dir, also, found);
  if (!frame.is_cloud()) io::write_png(dir / "planes.png", plane_image(frame, result));
  if (!frame.is_cloud() && found.tracks)
    io::write_png(dir / "tracks.png", track_image(frame, result, *found.tracks));
  io::write_ply(dir / "cloud.ply", labelled_cloud(frame, result));
}

}  // namespace planescope::report
