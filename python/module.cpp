// planescope._core: binds the library to Python. planescope/*.py converts its return values to
// dataclasses and numpy arrays.

#include <planescope/core.hpp>
#include <planescope/io.hpp>

#include "arrays.hpp"

using namespace planescope_python;

namespace {

using Gil = py::call_guard<py::gil_scoped_release>;

// ---- Frames ----

std::optional<ps::Vec3> gravity_of(const py::object& gravity) {
  if (gravity.is_none()) return std::nullopt;
  return gravity.cast<ps::Vec3>();
}

ps::Frame depth_frame(const py::object& depth,
                      const std::array<double, 4>& intrinsics,
                      const std::optional<std::array<double, 5>>& distortion,
                      const std::string& distortion_model,
                      std::optional<double> depth_unit,
                      const py::object& gravity,
                      const py::object& color) {
  const Input given(depth, "depth");
  const bool is_counts = given.is('u', 2);
  if ((!is_counts && !given.is('f', 4) && !given.is('f', 8)) || given.info.ndim != 2)
    given.fail("uint16 counts or float meters of shape (height, width)");
  if (!is_counts && depth_unit) throw ps::Error("depth_unit: depth is in meters; expected no unit");
  ps::DepthImage image;
  std::vector<std::uint16_t> counts;
  std::vector<float> meters;
  if (is_counts) {
    image.counts = given.rows<std::uint16_t>(image.row_stride);
    if (image.counts == nullptr) image.counts = (counts = given.values<std::uint16_t>()).data();
  } else {
    if (given.is('f', 4)) image.meters = given.rows<float>(image.row_stride);
    if (image.meters == nullptr) image.meters = (meters = given.values<float>()).data();
  }
  image.camera.width = static_cast<int>(given.info.shape[1]);
  image.camera.height = static_cast<int>(given.info.shape[0]);
  std::tie(image.camera.fx, image.camera.fy, image.camera.cx, image.camera.cy) =
      std::tuple_cat(intrinsics);
  if (distortion) {
    if (distortion_model != "brown_conrady" && distortion_model != "inverse_brown_conrady")
      throw ps::Error("unknown distortion_model '" + distortion_model +
                      "'; expected brown_conrady or inverse_brown_conrady");
    image.camera.distortion = distortion_model == "brown_conrady"
                                  ? ps::Distortion::brown_conrady
                                  : ps::Distortion::inverse_brown_conrady;
    image.camera.coefficients = *distortion;
  }
  image.unit_m = depth_unit.value_or(0.001);
  image.gravity = gravity_of(gravity);
  std::vector<std::uint8_t> rgb;
  if (!color.is_none()) {
    const Input of(color, "color");
    if (!of.is('u', 1) || of.info.ndim != 3 || of.info.shape[0] != given.info.shape[0] ||
        of.info.shape[1] != given.info.shape[1] || of.info.shape[2] != 3)
      of.fail("uint8 RGB of shape (height, width, 3), aligned with depth");
    rgb = of.values<std::uint8_t>();
    image.color.rgb = rgb.data();
    image.color.aligned = true;
  }
  return image;
}

/// Points (n, 3), or organized as (height, width, 3), which the frame stores as a flat list.
ps::Frame cloud_frame(const py::object& points, const py::object& gravity) {
  const Input given(points, "points");
  if ((given.info.ndim != 2 && given.info.ndim != 3) || given.info.shape.back() != 3 ||
      given.kind == 0)
    given.fail("meters of shape (points, 3) or (height, width, 3)");
  const std::vector<double> xyz = given.values<double>();
  ps::PointCloud cloud;
  cloud.xyz = xyz.data();
  cloud.size = xyz.size() / 3;
  cloud.gravity = gravity_of(gravity);
  const py::gil_scoped_release released;
  return cloud;
}

template <typename T>
py::object or_none(bool holds, const T& make) {
  return holds ? py::cast(make()) : py::none();
}

py::object depth_of(const ps::Frame& frame) {
  const ps::Camera camera = frame.depth().camera;
  return or_none(!frame.is_cloud(), [&] {
    return view_of(frame.depth().counts, {camera.height, camera.width}, frame);
  });
}

py::object color_of(const ps::Frame& frame) {
  const ps::ColorImage color = frame.depth().color;
  return or_none(color.rgb != nullptr, [&] {
    return view_of(color.rgb, {color.camera.height, color.camera.width, 3}, frame);
  });
}

py::object intrinsics_of(const ps::Camera& camera) {
  return or_none(camera.fx != 0, [&] {
    return array_of<double>(
        std::vector<double>{camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1}, {3, 3});
  });
}

py::object gravity_tuple(const std::optional<ps::Gravity>& gravity) {
  if (!gravity) return py::none();
  return py::make_tuple(vector_of(gravity->direction), gravity->source, gravity->confidence);
}

// ---- Planes ----

const char* name_of(ps::Label label) {
  return label == ps::Label::h ? "h" : label == ps::Label::v ? "v" : "unknown";
}

py::list rings_of(const std::vector<ps::Outline::Ring>& rings) {
  py::list list;
  for (const ps::Outline::Ring& ring : rings) list.append(rows_of(ring));
  return list;
}

py::dict outline_of(const ps::Outline& outline) {
  py::list parts;
  for (const ps::Outline::Part& part : outline.parts) {
    py::dict one;
    one["outer"] = rows_of(part.outer);
    one["holes"] = rings_of(part.holes);
    one["unknown"] = rings_of(part.unknown);
    parts.append(one);
  }
  py::dict dict;
  dict["origin"] = vector_of(outline.origin);
  dict["u"] = vector_of(outline.u);
  dict["v"] = vector_of(outline.v);
  dict["parts"] = parts;
  dict["area_m2"] = outline.area_m2;
  return dict;
}

py::list planes_of(const ps::Result& result) {
  const std::vector<ps::Plane>* planes = nullptr;
  {
    const py::gil_scoped_release released;
    planes = &result.planes();
  }
  py::list list;
  for (const ps::Plane& plane : *planes) {
    py::dict dict;
    dict["id"] = plane.id;
    dict["label"] = name_of(plane.label);
    dict["normal"] = vector_of(plane.normal);
    dict["centroid"] = vector_of(plane.centroid);
    dict["offset_m"] = plane.offset_m;
    dict["tilt_deg"] = plane.tilt_deg;
    dict["points"] = plane.points;
    dict["voxels"] = plane.voxels;
    dict["rms_m"] = plane.rms_m;
    dict["area_m2"] = plane.area_m2;
    dict["margin"] = plane.margin;
    dict["undecided"] = plane.undecided;
    dict["hull"] = rows_of(plane.hull);
    dict["outline"] = outline_of(plane.outline);
    dict["height_m"] = plane.height_m;
    dict["steppable"] = plane.steppable;
    dict["why_not"] = plane.why_not;
    list.append(dict);
  }
  return list;
}

py::tuple mesh_of(const ps::Result& result, int id) {
  ps::Mesh mesh;
  {
    const py::gil_scoped_release released;
    mesh = result.mesh(id);
  }
  return py::make_tuple(rows_of(mesh.vertices), array_of<int>(std::move(mesh.triangles)));
}

Array points_of(const ps::Result& result, Shape shape) {
  std::vector<ps::Vec3> points;
  {
    const py::gil_scoped_release released;
    points = result.points();
  }
  shape.push_back(3);
  return array_of<double>(std::move(points), std::move(shape));
}

py::dict counts_of(const ps::Result& result) {
  const ps::Counts counts = result.counts();
  py::dict dict;
  dict["points"] = counts.points;
  dict["no_measurement"] = counts.no_measurement;
  dict["invalid"] = counts.invalid;
  dict["beyond_range"] = counts.beyond_range;
  dict["outside_cube"] = counts.outside_cube;
  dict["kept"] = counts.kept;
  dict["voxels"] = counts.voxels;
  return dict;
}

py::dict timings_of(const ps::Result& result) {
  const ps::Timings timings = result.timings();
  py::dict dict;
  dict["cloud_ms"] = timings.cloud_ms;
  dict["voxels_ms"] = timings.voxels_ms;
  dict["classify_ms"] = timings.classify_ms;
  dict["octree_ms"] = timings.octree_ms;
  dict["segment_ms"] = timings.segment_ms;
  return dict;
}

py::tuple map_of(const ps::Map& made) {
  std::vector<ps::Transform> poses = made.T_world_camera;
  const auto count = static_cast<py::ssize_t>(poses.size());
  py::dict planes;
  for (const auto& [frame, png] : made.planes_png) planes[py::int_(frame)] = py::bytes(png);
  return py::make_tuple(py::bytes(made.map_json), py::bytes(made.tracks_json),
                        py::bytes(made.poses_tum), made.pose_frames,
                        array_of<double>(std::move(poses), {count, 4, 4}), made.warnings, planes);
}

// A node as a record.
struct NodeRecord {
  static constexpr const char* kFormat =
      "T{i:parent:i:depth:i:case:I:voxels:I:voxels_h:4x(8,3)d:corners:i:queued:i:visited:i:decided:"
      "4x}";
  std::int32_t parent, depth, node_case;
  std::uint32_t voxels, voxels_h;
  std::array<std::array<double, 3>, 8> corners;
  std::int32_t queued, visited, decided;
};

std::vector<NodeRecord> records_of(const std::vector<ps::Node>& nodes) {
  std::vector<NodeRecord> records;
  records.reserve(nodes.size());
  for (const ps::Node& node : nodes)
    records.push_back({node.parent, node.depth, node.node_case, node.voxels, node.voxels_h,
                       node.corners, node.queued, node.visited, node.decided});
  return records;
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  // A message may contain a file name that is not valid UTF-8.
  static py::exception<ps::Error> error_type(m, "Error", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const ps::Error& error) {
      const auto text = py::reinterpret_steal<py::object>(PyUnicode_DecodeFSDefault(error.what()));
      PyErr_SetObject(error_type.ptr(), text.ptr());
    }
  });
  m.attr("__version__") = PLANESCOPE_VERSION;

  py::class_<Array>(m, "Array", py::buffer_protocol()).def_buffer([](const Array& array) {
    return array.buffer();
  });

  py::class_<ps::Frame>(m, "Frame")
      .def(py::init(&depth_frame), py::arg("depth"), py::arg("intrinsics"), py::arg("distortion"),
           py::arg("distortion_model"), py::arg("depth_unit"), py::arg("gravity"), py::arg("color"))
      .def_static("of_points", &cloud_frame, py::arg("points"), py::arg("gravity"))
      .def("to_bytes", [](const ps::Frame& frame) { return py::bytes(frame.bytes()); })
      .def_static("of_bytes", &ps::Frame::from_bytes)
      .def_property_readonly("index", &ps::Frame::index)
      .def_property_readonly("name", [](const ps::Frame& frame) { return py::bytes(frame.name()); })
      .def_property_readonly("size", &ps::Frame::size)
      .def_property_readonly(
          "distortion_model",
          [](const ps::Frame& frame) {
            const char* const names[] = {"none", "brown_conrady", "inverse_brown_conrady"};
            return names[static_cast<int>(frame.depth().camera.distortion)];
          })
      .def_property_readonly("distortion",
                             [](const ps::Frame& frame) {
                               const ps::Camera camera = frame.depth().camera;
                               const auto& k = camera.coefficients;
                               return or_none(camera.distortion != ps::Distortion::none, [&] {
                                 return array_of<double>(std::vector(k.begin(), k.end()));
                               });
                             })
      .def_property_readonly("timestamp_s", &ps::Frame::timestamp_s)
      .def_property_readonly("is_cloud", &ps::Frame::is_cloud)
      .def_property_readonly("depth", &depth_of)
      .def_property_readonly("color", &color_of)
      .def_property_readonly("depth_unit",
                             [](const ps::Frame& frame) { return frame.depth().unit_m; })
      .def_property_readonly(
          "K", [](const ps::Frame& frame) { return intrinsics_of(frame.depth().camera); })
      .def_property_readonly(
          "color_K",
          [](const ps::Frame& frame) { return intrinsics_of(frame.depth().color.camera); })
      .def_property_readonly("color_is_aligned",
                             [](const ps::Frame& frame) { return frame.depth().color.aligned; })
      .def_property_readonly(
          "T_color_depth",
          [](const ps::Frame& frame) { return transform_of(frame.depth().color.T_color_depth); })
      .def_property_readonly("points",
                             [](const ps::Frame& frame) { return rows_of(frame.points()); })
      .def_property_readonly("gravity",
                             [](const ps::Frame& frame) { return gravity_tuple(frame.gravity()); });

  py::class_<ps::Recording>(m, "Recording")
      .def(py::init([](const std::string& path, const std::optional<std::array<double, 4>>& k,
                       std::optional<double> depth_unit, bool color) {
             ps::RecordingOptions options;
             options.intrinsics = k;
             options.depth_unit_m = depth_unit;
             options.color = color;
             return ps::Recording(path, options);
           }),
           py::arg("path"), py::arg("intrinsics"), py::arg("depth_unit"), py::arg("color"), Gil())
      .def("size", &ps::Recording::size)
      .def("frame", &ps::Recording::operator[], Gil())
      .def("timestamp_s", &ps::Recording::timestamp_s, Gil())
      .def("info", [](const ps::Recording& recording) {
        const ps::RecordingInfo info = recording.info();
        py::dict dict;
        dict["path"] = py::bytes(info.path);
        dict["format"] = info.format;
        dict["device"] = info.device;
        dict["width"] = info.camera.width;
        dict["height"] = info.camera.height;
        dict["K"] = intrinsics_of(info.camera);
        dict["depth_unit"] = info.depth_unit_m;
        dict["has_color"] = info.has_color;
        dict["warnings"] = info.warnings;
        py::dict damaged;
        for (const auto& [frame, why] : info.damaged) damaged[py::int_(frame)] = py::bytes(why);
        dict["damaged"] = damaged;
        return dict;
      });

  py::class_<ps::Options>(m, "Options")
      .def(py::init<const std::string&>())
      .def("set", py::overload_cast<const std::string&, const std::string&>(&ps::Options::set))
      .def("get", &ps::Options::get)
      .def_static("all", [] {
        py::list list;
        for (const ps::OptionInfo& info : ps::Options::all())
          list.append(py::make_tuple(info.name, info.unit, info.meaning, info.section, info.paper,
                                     info.refined));
        return list;
      });

  py::class_<ps::Result>(m, "Result")
      .def_property_readonly("frame", &ps::Result::frame)
      .def("planes", &planes_of)
      .def("labels",
           [](const ps::Result& result, const Shape& shape) {
             return view_of(result.plane_of().data(), shape, result);
           })
      .def("inclination",
           [](const ps::Result& result, const Shape& shape) {
             const ps::Label* labels = result.label_of().data();
             return view_of(reinterpret_cast<const std::uint8_t*>(labels), shape, result);
           })
      .def("points", &points_of)
      .def("mesh", &mesh_of)
      .def_property_readonly(
          "gravity", [](const ps::Result& result) { return gravity_tuple(result.gravity()); })
      .def_property_readonly(
          "T_world_sensor",
          [](const ps::Result& result) { return transform_of(result.T_world_sensor()); })
      .def("counts", &counts_of)
      .def("timings", &timings_of)
      .def("json", &ps::Result::json, Gil())
      .def("text", &ps::Result::text, Gil());

  py::class_<ps::Trace>(m, "Trace")
      .def("steps", &ps::Trace::steps)
      .def_property_readonly("events",
                             [](const ps::Trace& trace) {
                               const ps::View<ps::Event> events = trace.events();
                               return view_of(events.data(),
                                              {static_cast<py::ssize_t>(events.size())}, trace);
                             })
      .def_property_readonly(
          "nodes",
          [](const ps::Trace& trace) { return array_of<NodeRecord>(records_of(trace.nodes())); })
      .def_static("stages", &ps::Trace::stages)
      .def("describe", &ps::Trace::describe)
      .def("plane_of",
           [](const ps::Trace& trace, int step, Shape shape) {
             std::vector<std::int32_t> planes;
             {
               const py::gil_scoped_release released;
               planes = trace.plane_of(step);
             }
             return array_of<std::int32_t>(std::move(planes), std::move(shape));
           })
      .def("plane_at",
           [](const ps::Trace& trace, int step, std::size_t i) { return trace.plane_of(step, i); })
      .def("id_of", &ps::Trace::id_of)
      .def("result", &ps::Trace::result, Gil());

  py::class_<ps::Segmenter>(m, "Segmenter")
      .def(py::init<const ps::Options&, int>())
      .def("segment", &ps::Segmenter::segment, Gil())
      .def("trace", &ps::Segmenter::trace, Gil());

  m.def(
      "make_map",
      [](const ps::Recording& recording, const ps::Segmenter& segmenter, const std::string& poses,
         double window_m, const std::vector<int>& frames,
         const std::map<int, ps::Transform>& T_world_camera, bool skip_damaged) {
        const ps::Map made = [&] {
          const py::gil_scoped_release others_run;
          return ps::make_map(recording, segmenter,
                              {poses, window_m, frames, T_world_camera, skip_damaged});
        }();
        return map_of(made);
      },
      py::arg("recording"), py::arg("segmenter"), py::arg("poses"), py::arg("window_m"),
      py::arg("frames"), py::arg("T_world_camera"), py::arg("skip_damaged"));

  py::class_<ps::Mapper>(m, "Mapper")
      .def(py::init<const ps::Segmenter&, double>())
      .def("add",
           [](ps::Mapper& mapper, const ps::Frame& frame, const ps::Transform& T_world_camera) {
             const ps::MappedFrame added = [&] {
               const py::gil_scoped_release released;
               return mapper.add(frame, T_world_camera);
             }();
             return py::make_tuple(added.result, added.tracks, transform_of(added.T_world_camera),
                                   added.set_aside);
           })
      .def("size", &ps::Mapper::size)
      .def("map", [](const ps::Mapper& mapper) {
        const ps::Map made = [&] {
          const py::gil_scoped_release released;
          return mapper.map();
        }();
        return map_of(made);
      });
}
