// planescope._core: the library over numpy arrays. planescope/__init__.py makes dataclasses of what
// it returns.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <planescope/core.hpp>
#include <planescope/io.hpp>

namespace py = pybind11;
namespace ps = planescope;

namespace {

using Vectors = py::array_t<double>;
using Gil = py::call_guard<py::gil_scoped_release>;

// Arrays.

/// An array over memory that `owner` keeps; not to be written to.
template <typename T>
py::array view_of(const T* data, const std::vector<py::ssize_t>& shape, const py::handle& owner) {
  py::array array(py::dtype::of<T>(), shape, data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// An array that takes over a vector.
template <typename T>
py::array array_of(std::vector<T>&& values) {
  auto* kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array(py::dtype::of<T>(), {static_cast<py::ssize_t>(kept->size())}, kept->data(),
                   owner);
}

template <std::size_t N>
Vectors rows_of(const std::vector<std::array<double, N>>& rows) {
  Vectors array({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(N)});
  if (!rows.empty()) std::copy_n(rows[0].data(), rows.size() * N, array.mutable_data());
  return array;
}

Vectors vector_of(const ps::Vec3& p) { return Vectors(3, p.data()); }
Vectors transform_of(const ps::Transform& t) { return Vectors({4, 4}, t.data()); }

// One value per pixel, or point, of a frame: [height, width] or [points].
std::vector<py::ssize_t> shape_of(const ps::Frame& frame) {
  if (frame.is_cloud()) return {static_cast<py::ssize_t>(frame.size())};
  const ps::Camera camera = frame.depth().camera;
  return {camera.height, camera.width};
}

std::string text_of(const py::handle& array) {
  return py::str(array.attr("dtype")).cast<std::string>() + " of shape " +
         py::str(array.attr("shape")).cast<std::string>();
}

// Frames.

std::optional<ps::Vec3> gravity_of(const py::object& gravity) {
  if (gravity.is_none()) return std::nullopt;
  return gravity.cast<ps::Vec3>();
}

ps::Frame depth_frame(const py::array& depth,
                      const std::array<double, 4>& intrinsics,
                      const std::optional<std::array<double, 5>>& distortion,
                      const std::string& distortion_model,
                      double depth_unit,
                      const py::object& gravity,
                      const py::object& color) {
  if (!py::isinstance<py::array_t<std::uint16_t>>(depth) || depth.ndim() != 2)
    throw ps::Error("depth: it is " + text_of(depth) +
                    ", expected uint16 counts of shape (height, width)");
  // Rows may stand apart, as those of a part of an image do; pixels may not.
  py::array rows = depth;
  const auto size = static_cast<py::ssize_t>(sizeof(std::uint16_t));
  if (rows.strides(1) != size || rows.strides(0) < rows.shape(1) * size ||
      rows.strides(0) % size != 0)
    rows = py::array_t<std::uint16_t, py::array::c_style | py::array::forcecast>(depth);
  ps::DepthImage image;
  image.counts = static_cast<const std::uint16_t*>(rows.data());
  image.row_stride = static_cast<std::size_t>(rows.strides(0) / size);
  image.camera.width = static_cast<int>(rows.shape(1));
  image.camera.height = static_cast<int>(rows.shape(0));
  std::tie(image.camera.fx, image.camera.fy, image.camera.cx, image.camera.cy) =
      std::tuple_cat(intrinsics);
  if (distortion) {
    if (distortion_model != "brown_conrady" && distortion_model != "inverse_brown_conrady")
      throw ps::Error("distortion_model '" + distortion_model +
                      "': expected brown_conrady or inverse_brown_conrady");
    image.camera.distortion = distortion_model == "brown_conrady"
                                  ? ps::Distortion::brown_conrady
                                  : ps::Distortion::inverse_brown_conrady;
    image.camera.coefficients = *distortion;
  }
  image.unit_m = depth_unit;
  image.gravity = gravity_of(gravity);
  py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast> rgb;
  if (!color.is_none()) {
    const py::array given = py::array::ensure(color);
    if (!given || !py::isinstance<py::array_t<std::uint8_t>>(given) || given.ndim() != 3 ||
        given.shape(0) != rows.shape(0) || given.shape(1) != rows.shape(1) || given.shape(2) != 3)
      throw ps::Error("color: it is " + (given ? text_of(given) : std::string("no array")) +
                      ", expected uint8 RGB on the pixels of depth");
    rgb = given;
    image.color.rgb = rgb.data();
    image.color.aligned = true;
  }
  return image;
}

ps::Frame cloud_frame(const py::array& points, const py::object& gravity) {
  if (points.ndim() != 2 || points.shape(1) != 3 ||
      std::string("fiu").find(points.dtype().kind()) == std::string::npos)
    throw ps::Error("points: they are " + text_of(points) +
                    ", expected metres of shape (points, 3)");
  const py::array_t<double, py::array::c_style | py::array::forcecast> xyz(points);
  ps::PointCloud cloud;
  cloud.xyz = xyz.data();
  cloud.size = static_cast<std::size_t>(xyz.shape(0));
  cloud.gravity = gravity_of(gravity);
  const py::gil_scoped_release released;
  return cloud;
}

py::object depth_of(const py::object& self) {
  const auto& frame = self.cast<const ps::Frame&>();
  if (frame.is_cloud()) return py::none();
  return view_of(frame.depth().counts, shape_of(frame), self);
}

py::object color_of(const py::object& self) {
  const ps::ColorImage color = self.cast<const ps::Frame&>().depth().color;
  if (color.rgb == nullptr) return py::none();
  return view_of(color.rgb, {color.camera.height, color.camera.width, 3}, self);
}

py::object intrinsics_of(const ps::Camera& camera) {
  if (camera.fx == 0) return py::none();
  const std::array<double, 9> k = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  return Vectors({3, 3}, k.data());
}

py::object gravity_tuple(const std::optional<ps::Gravity>& gravity) {
  if (!gravity) return py::none();
  return py::make_tuple(vector_of(gravity->direction), gravity->source, gravity->confidence);
}

// Planes.

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
  py::array_t<int> triangles({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
  if (!mesh.triangles.empty())
    std::copy_n(mesh.triangles[0].data(), mesh.triangles.size() * 3, triangles.mutable_data());
  return py::make_tuple(rows_of(mesh.vertices), triangles);
}

py::array points_of(const ps::Result& result) {
  std::vector<py::ssize_t> shape = shape_of(result.frame());
  shape.push_back(3);
  auto* kept = new std::vector<ps::Vec3>();
  {
    const py::gil_scoped_release released;
    *kept = result.points();
  }
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<ps::Vec3>*>(p); });
  return py::array(py::dtype::of<double>(), shape, kept->data(), owner);
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

// A node as a record.
struct NodeRecord {
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
  PYBIND11_NUMPY_DTYPE_EX(ps::Event, type, "type", node_case, "case", stage, "stage", label,
                          "label", node, "node", plane, "plane", other, "other", point, "point",
                          value, "value");
  PYBIND11_NUMPY_DTYPE_EX(NodeRecord, parent, "parent", depth, "depth", node_case, "case", voxels,
                          "voxels", voxels_h, "voxels_h", corners, "corners", queued, "queued",
                          visited, "visited", decided, "decided");
  // A message may name a file whose name is no UTF-8.
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

  py::class_<ps::Frame>(m, "Frame")
      .def(py::init(&depth_frame), py::arg("depth"), py::arg("intrinsics"), py::arg("distortion"),
           py::arg("distortion_model"), py::arg("depth_unit"), py::arg("gravity"), py::arg("color"))
      .def_static("of_points", &cloud_frame, py::arg("points"), py::arg("gravity") = py::none())
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
                             [](const ps::Frame& frame) -> py::object {
                               const ps::Camera camera = frame.depth().camera;
                               if (camera.distortion == ps::Distortion::none) return py::none();
                               return Vectors(5, camera.coefficients.data());
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
      .def_property_readonly("labels",
                             [](const py::object& self) {
                               const auto& result = self.cast<const ps::Result&>();
                               return view_of(result.plane_of().data(), shape_of(result.frame()),
                                              self);
                             })
      .def_property_readonly("inclination",
                             [](const py::object& self) {
                               const auto& result = self.cast<const ps::Result&>();
                               return view_of(
                                   reinterpret_cast<const std::uint8_t*>(result.label_of().data()),
                                   shape_of(result.frame()), self);
                             })
      .def_property_readonly("points", &points_of)
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
      .def_property_readonly(
          "events",
          [](const py::object& self) {
            const ps::View<ps::Event> events = self.cast<const ps::Trace&>().events();
            return view_of(events.data(), {static_cast<py::ssize_t>(events.size())}, self);
          })
      .def_property_readonly(
          "nodes", [](const ps::Trace& trace) { return array_of(records_of(trace.nodes())); })
      .def_static("stages", &ps::Trace::stages)
      .def("describe", &ps::Trace::describe)
      .def("plane_of",
           [](const ps::Trace& trace, int step) {
             std::vector<std::int32_t> planes;
             {
               const py::gil_scoped_release released;
               planes = trace.plane_of(step);
             }
             return array_of(std::move(planes));
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
         double window_m, const std::vector<int>& frames) {
        const auto made = [&] {
          const py::gil_scoped_release others_run;
          return ps::make_map(recording, segmenter, {poses, window_m, frames});
        }();
        Vectors poses_of(
            {static_cast<py::ssize_t>(made.T_world_camera.size()), py::ssize_t{4}, py::ssize_t{4}});
        for (std::size_t i = 0; i < made.T_world_camera.size(); ++i)
          std::copy_n(made.T_world_camera[i].data(), 16, poses_of.mutable_data() + 16 * i);
        py::dict planes;
        for (const auto& [frame, png] : made.planes_png) planes[py::int_(frame)] = py::bytes(png);
        return py::make_tuple(py::bytes(made.map_json), py::bytes(made.tracks_json),
                              py::bytes(made.poses_tum), made.pose_frames, poses_of, made.told,
                              planes);
      },
      py::arg("recording"), py::arg("segmenter"), py::arg("poses"), py::arg("window_m"),
      py::arg("frames"));
}
