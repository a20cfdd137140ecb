#pragma once

// planescope's library: planes in depth images and point clouds, after Sun et al. 2023,
// "Multi-Resolution Planar Region Extraction for Uneven Terrains". What stands in these headers is
// all that programs see of it, and stays as it is for a minor version (docs/library.md).
//
// Lengths are metres, angles degrees, image coordinates pixels from the centre of the upper left
// one. The sensor's frame is that of cameras: x right, y down, z forward. The world's has z up,
// against gravity, and the sensor at its origin; of a cloud, its own origin. Everything that cannot
// be done throws Error with one line: what was found and what was expected. Objects are cheap to
// copy, and const functions may be called from several threads at once. What is given as a view or
// a reference lives as long as its object: of one that is about to go it is a copy, or not to be
// had.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planescope/version.hpp"

#define PLANESCOPE_API __attribute__((visibility("default")))

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // which has types of the same names, in planescope itself
namespace v0 {
#else
inline namespace v0 {
#endif
namespace detail {
struct ResultData;
struct SegmenterData;
struct TraceData;
struct Access;
}  // namespace detail

using Vec2 = std::array<double, 2>;
using Vec3 = std::array<double, 3>;
/// A rigid transform, 4x4, row by row. T_a_b takes coordinates in frame b to those in frame a.
using Transform = std::array<double, 16>;
inline constexpr Transform kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

class PLANESCOPE_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  Error(const Error&) = default;
  Error& operator=(const Error&) = default;
  ~Error() override;
};

/// Elements in a row that somebody else owns.
template <typename T>
class View {
 public:
  View() = default;
  View(const T* data, std::size_t size) : data_(data), size_(size) {}
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

// What comes in.

enum class Distortion : std::uint8_t { none, brown_conrady, inverse_brown_conrady };

/// A pinhole camera: pixel (u, v) looks along ((u - cx) / fx, (v - cy) / fy, 1).
struct Camera {
  int width = 0, height = 0;                             // [px]
  double fx = 0, fy = 0, cx = 0, cy = 0;                 // [px]
  Distortion distortion = Distortion::none;              // brown_conrady: as OpenCV has it
  std::array<double, 5> coefficients = {0, 0, 0, 0, 0};  // k1 k2 p1 p2 k3
};

/// A colour picture of the same moment: shown under planes, never segmented by.
struct ColorImage {
  const std::uint8_t* rgb = nullptr;  // [height * width * 3], null: there is none
  Camera camera;                      // fx 0: not calibrated
  bool aligned = false;               // on the pixels of the depth image, and of its size
  Transform T_color_depth = kIdentity;
};

/// Pixels as counts or in meters. Meters are stored as counts: of 1 mm if every
/// pixel is a whole number of millimeters or one is beyond 13.1 m, otherwise of 0.2 mm. Beyond
/// 65.534 m they are invalid.
struct DepthImage {
  const std::uint16_t* counts = nullptr;  // [height * width] of the camera; 0: not measured
  const float* meters = nullptr;          // instead of counts; 0, negative, NaN: not measured
  Camera camera;
  double unit_m = 0.001;        // meters per count
  std::size_t row_stride = 0;   // from one row to the next, in pixels; 0: the width
  std::optional<Vec3> gravity;  // where things fall, in the sensor's frame, of any length;
                                // nothing: it is estimated from the image
  ColorImage color;
};

struct PointCloud {
  const double* xyz = nullptr;  // [size * 3]; NaN and (0, 0, 0): not measured
  std::size_t size = 0;
  const std::uint8_t* rgb = nullptr;  // [size * 3], null: there is none
  std::optional<Vec3> gravity;        // in the cloud's own frame; nothing: -z
};

struct Gravity {
  Vec3 direction = {0, 0, 0};  // unit, in the sensor's frame
  std::string source;     // "option", "sidecar", "imu", "picked", "estimate", "assumed"; "none": it
                          // is not known, and nothing is h or v
  double confidence = 0;  // 0 to 1; below 1 of estimates only
};

/// One frame, with pictures and points of its own.
class PLANESCOPE_API Frame {
 public:
  /// Copies what it is given.
  Frame(const DepthImage& image);
  Frame(const PointCloud& cloud);
  Frame(const Frame&) = default;  // moving is copying: there is no empty frame
  Frame& operator=(const Frame&) = default;

  int index() const;                 // in its recording, from 0
  const std::string& name() const&;  // as the recording calls it
  std::string name() &&;
  double timestamp_s() const;  // the sensor's clock; 0: not known
  bool is_cloud() const;
  /// Pixels of the depth image, or points of the cloud: what labels of a frame are as many as.
  std::size_t size() const;
  /// As a Frame takes it, its pictures in this frame's memory. Of a cloud: without any.
  DepthImage depth() const&;
  DepthImage depth() && = delete;
  /// Of a cloud, in its order. Of a depth image: none.
  std::vector<Vec3> points() const;
  std::optional<Gravity> gravity() const;  // as its recording tells
  /// All of the frame, for another process that runs this version of the library.
  std::string bytes() const;
  /// The frame of these bytes(). Throws Error if they are damaged or of another version.
  static Frame from_bytes(const std::string& bytes);

 private:
  friend struct detail::Access;
  Frame() = default;
  std::shared_ptr<const void> data_;
};

enum class OptionKind : std::uint8_t { number, whole, on_off, choice, text };

struct OptionInfo {
  std::string name, unit, meaning, section;
  std::string paper, refined;  // its value in the two profiles
  OptionKind kind = OptionKind::text;
  double min = 0, max = std::numeric_limits<double>::infinity();  // of number and whole
  bool min_excluded = false;
  std::vector<std::string> choices = {};  // of choice
};

/// Everything that can be set, by the names that `planescope options` lists.
class PLANESCOPE_API Options {
 public:
  /// "refined", or "paper": the method as written.
  explicit Options(const std::string& profile = "refined");
  Options(const Options& other);
  Options& operator=(const Options& other);
  ~Options();
  /// Error names the nearest option where there is none of this name. `max_range_m` crops clouds as
  /// well, unless `range_for_clouds` was set.
  Options& set(const std::string& name, const std::string& value);
  Options& set(const std::string& name, double value);
  std::string get(const std::string& name) const;
  static std::vector<OptionInfo> all();

 private:
  friend struct detail::Access;
  struct Data;
  std::unique_ptr<Data> data_;
};

// What comes out.

/// Local inclination: h up to 45 degrees from the level, v above.
enum class Label : std::uint8_t { unknown = 0, h = 1, v = 2 };

/// What a plane covers, as polygons on it: (x, y) stands for origin + x u + y v.
struct Outline {
  using Ring = std::vector<Vec2>;  // not closed by a repeated corner
  struct Part {
    Ring outer;                 // counter-clockwise from where the normal points
    std::vector<Ring> holes;    // clockwise: something else was seen there, or through the plane
    std::vector<Ring> unknown;  // clockwise: nothing was measured there
  };
  Vec3 origin = {0, 0, 0}, u = {1, 0, 0}, v = {0, 1, 0};  // world
  std::vector<Part> parts;                                // the largest first
  double area_m2 = 0;                                     // without holes and what is unknown

  Vec3 world(const Vec2& p) const {
    return {origin[0] + p[0] * u[0] + p[1] * v[0], origin[1] + p[0] * u[1] + p[1] * v[1],
            origin[2] + p[0] * u[2] + p[1] * v[2]};
  }
};

/// In the world's frame; the normal points up (h) or to the sensor's side (v).
struct Plane {
  int id = 0;  // from 1
  Label label = Label::unknown;
  Vec3 normal = {0, 0, 1};  // unit
  Vec3 centroid = {0, 0, 0};
  double offset_m = 0;       // normal . x of its points
  double tilt_deg = 0;       // 0 a floor, 90 a wall; NaN: gravity is not known
  std::uint64_t points = 0;  // measurements on it
  std::uint64_t voxels = 0;
  double rms_m = 0;    // of its measurements' distances
  double area_m2 = 0;  // of the cells that hold points
  // How far the plane is from being lost, or joined with a neighbor at least as large;
  // infinite where no objective was minimized.
  double margin = std::numeric_limits<double>::infinity();
  bool undecided = false;  // the margin is below the threshold
  std::vector<Vec3> hull;  // convex, counter-clockwise from where the normal points
  Outline outline;
  double height_m = std::numeric_limits<double>::quiet_NaN();  // above the floor; NaN: not level
  bool steppable = false;  // where an option tells the foot: whether it can stand here
  std::string why_not;     // and why not
};

/// Triangles, counter-clockwise from where the plane's normal points.
struct Mesh {
  std::vector<Vec3> vertices;  // world
  std::vector<std::array<int, 3>> triangles;
};

/// Points of a frame by what became of them.
struct Counts {
  std::uint64_t points = 0;  // of the image or cloud
  std::uint64_t no_measurement = 0, invalid = 0, beyond_range = 0, outside_cube = 0;
  std::uint64_t kept = 0;    // the rest: what was segmented
  std::uint64_t voxels = 0;  // that these went into
};

/// Milliseconds of a frame, as the paper's table IV splits them.
struct Timings {
  double cloud_ms = 0;     // back-projection
  double voxels_ms = 0;    // t_d
  double classify_ms = 0;  // t_c
  double octree_ms = 0;    // t_b
  double segment_ms = 0;   // t_s
};

/// The planes of one frame.
class PLANESCOPE_API Result {
 public:
  const Frame& frame() const&;
  Frame frame() &&;
  /// By id - 1. Outlines, heights and footholds are found when they are first asked for.
  const std::vector<Plane>& planes() const&;
  std::vector<Plane> planes() &&;
  /// Plane id of each pixel [height * width] or point, 0 of none.
  View<std::int32_t> plane_of() const&;
  View<std::int32_t> plane_of() && = delete;
  /// Label of each, as the classifier had it.
  View<Label> label_of() const&;
  View<Label> label_of() && = delete;
  /// Where each is in the world; NaN: not measured.
  std::vector<Vec3> points() const;
  /// What a plane covers, without its holes. Error: there is no such id.
  Mesh mesh(int id) const;
  const Gravity& gravity() const&;
  Gravity gravity() &&;
  Transform T_world_sensor() const;
  Counts counts() const;
  Timings timings() const;
  /// planes.json, as `planescope segment` writes it: flights of stairs, kerbs and ramps as well.
  std::string json() const;
  /// In another tool's format: "geojson", "obj", "ply", "planar-terrain", "csv", "svg".
  std::string text(const std::string& format) const;

 private:
  friend struct detail::Access;
  Result() = default;
  std::shared_ptr<const detail::ResultData> data_;
};

enum class EventType : std::uint8_t {
  visit,   // a node is taken from the queue
  decide,  // a node is settled; value: e_n where it was computed
  found,   // a node's candidate founds a plane
  merge,   // a node's candidate joins `plane`; value: |n . dmu| [m]
  assign,  // a leftover point goes to `plane`; value: distance [m]
  drop,    // a leftover point stays without a plane
  refine,  // the objective joined, changed or dropped `plane`
};

/// One decision. -1: does not apply.
struct Event {
  EventType type;
  std::uint8_t node_case;  // of decide: 1 to 4 for the paper's cases I to IV
  std::uint8_t stage;      // what decided: index into Trace::stages()
  Label label;             // of the candidate
  std::int32_t node;       // index into Trace::nodes()
  std::int32_t plane;      // in order of founding: not the id that planes have at the end
  std::int32_t other;      // second plane
  std::int32_t point;      // voxel
  float value;
};

/// A node of the octree. Steps: after so many events; kNever: it never is.
struct Node {
  static constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();
  std::int32_t parent = -1;
  int depth = 0;
  std::uint8_t node_case = 0;  // in which it was settled
  std::uint32_t voxels = 0, voxels_h = 0;
  /// Of its cell, world. An index has bit 0 for greater x, or pixel u; bit 1 for greater y, or
  /// pixel v; bit 2 for greater z, or farther from the camera.
  std::array<Vec3, 8> corners = {};
  std::int32_t queued = kNever, visited = kNever, decided = kNever;
};

/// How the planes of a frame came about: step k is the state after k events.
class PLANESCOPE_API Trace {
 public:
  int steps() const { return static_cast<int>(events().size()); }
  View<Event> events() const&;
  View<Event> events() && = delete;
  /// "criteria", "merge" or "assign"; "join" to "list" by the objective.
  static std::vector<std::string> stages();
  /// What the event that led to step k did, in one line; 1 <= k <= steps().
  std::string describe(int step) const;
  std::vector<Node> nodes() const;  // breadth-first, the root first
  /// At a step, plane of each pixel or point in order of founding, -1: none.
  std::vector<std::int32_t> plane_of(int step) const;
  std::int32_t plane_of(int step, std::size_t i) const;  // of one of them
  /// The id at the end of a plane in order of founding, 0: it is none of the result's.
  int id_of(int plane) const;
  Result result() const;

 private:
  friend struct detail::Access;
  Trace() = default;
  std::shared_ptr<const detail::TraceData> data_;
};

/// Options and the classifier that they name, ready for frames.
class PLANESCOPE_API Segmenter {
 public:
  /// Results are the same for any number of threads.
  explicit Segmenter(const Options& options = Options(), int threads = 1);
  Result segment(const Frame& frame) const;
  /// The same with every decision kept. Error where the options name another method than ours.
  Trace trace(const Frame& frame) const;

 private:
  friend struct detail::Access;
  std::shared_ptr<const detail::SegmenterData> data_;
};

/// For a single frame.
inline Result segment(const Frame& frame, const Options& options = Options()) {
  return Segmenter(options).segment(frame);
}

}  // namespace v0
}  // namespace planescope
