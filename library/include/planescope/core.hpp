#pragma once

// Public C++ interface of planescope: finds planes in depth images and point clouds, after Sun et
// al. 2023, "Multi-Resolution Planar Region Extraction for Uneven Terrains". Programs see only
// these headers, which remain compatible within a minor version (docs/library.md).
//
// Lengths are in meters, angles in degrees. Image coordinates are in pixels from the center of the
// upper left pixel. The sensor's frame is that of cameras: x right, y down, z forward. In the
// world, z points up, against gravity, and the sensor is at the origin (of a cloud: the cloud's own
// origin). Functions that fail throw Error with one line: what was found and what was expected.
// Objects are cheap to copy, and const functions may be called from several threads at once. Views
// and references are valid as long as their object; on temporary objects, these functions return a
// copy or are deleted.

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
#ifdef PLANESCOPE_LIBRARY_SOURCE  // planescope itself has types of the same names
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

/// A contiguous array that is not owned.
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

// Input.

enum class Distortion : std::uint8_t { none, brown_conrady, inverse_brown_conrady };

/// A pinhole camera: pixel (u, v) looks along ((u - cx) / fx, (v - cy) / fy, 1).
struct Camera {
  int width = 0, height = 0;                             // [px]
  double fx = 0, fy = 0, cx = 0, cy = 0;                 // [px]
  Distortion distortion = Distortion::none;              // brown_conrady: as in OpenCV
  std::array<double, 5> coefficients = {0, 0, 0, 0, 0};  // k1 k2 p1 p2 k3
};

/// A color image taken at the same time: shown under planes, not used to find them.
struct ColorImage {
  const std::uint8_t* rgb = nullptr;  // [height * width * 3]; null: no color
  Camera camera;                      // fx 0: not calibrated
  bool aligned = false;               // same size and pixels as the depth image
  Transform T_color_depth = kIdentity;
};

/// Depth as counts or in meters. Meters are stored as counts of 1 mm if every pixel is a whole
/// number of millimeters or one is beyond 13.1 m, otherwise of 0.2 mm. Pixels beyond 65.534 m are
/// invalid.
struct DepthImage {
  const std::uint16_t* counts = nullptr;  // [height * width] of the camera; 0: not measured
  const float* meters = nullptr;          // instead of counts; 0, negative, NaN: not measured
  Camera camera;
  double unit_m = 0.001;        // meters per count
  std::size_t row_stride = 0;   // pixels from one row to the next; 0: the width
  std::optional<Vec3> gravity;  // direction of gravity in the sensor's frame, of any length;
                                // nullopt: estimated from the image
  ColorImage color;
};

struct PointCloud {
  const double* xyz = nullptr;  // [size * 3]; NaN or (0, 0, 0): not measured
  std::size_t size = 0;
  const std::uint8_t* rgb = nullptr;  // [size * 3]; null: no color
  std::optional<Vec3> gravity;        // in the cloud's own frame; nullopt: -z
};

struct Gravity {
  Vec3 direction = {0, 0, 0};  // unit, in the sensor's frame
  std::string source;     // "option", "sidecar", "imu", "picked", "estimate", "assumed"; "none":
                          // unknown, no plane is h or v
  double confidence = 0;  // 0 to 1; below 1 only for estimates
};

/// A depth image or a point cloud, which owns its data.
class PLANESCOPE_API Frame {
 public:
  /// Copies the image or cloud.
  Frame(const DepthImage& image);
  Frame(const PointCloud& cloud);
  Frame(const Frame&) = default;  // a move copies, so that no frame is ever empty
  Frame& operator=(const Frame&) = default;

  int index() const;                 // number in its recording, from 0
  const std::string& name() const&;  // name in its recording
  std::string name() &&;
  double timestamp_s() const;  // time of the sensor's clock; 0: unknown
  bool is_cloud() const;
  /// Number of pixels of the depth image or points of the cloud; Result has a label for each.
  std::size_t size() const;
  /// The depth image; its pointers refer to this frame's memory. Without data for a cloud.
  DepthImage depth() const&;
  DepthImage depth() && = delete;
  /// Points of a cloud in their original order; empty for a depth image.
  std::vector<Vec3> points() const;
  std::optional<Gravity> gravity() const;  // from the recording or the caller
  /// Serializes the frame, for another process with this version of the library.
  std::string bytes() const;
  /// Reads the result of bytes(). Throws Error if it is damaged or from another version.
  static Frame from_bytes(const std::string& bytes);

 private:
  friend struct detail::Access;
  Frame() = default;
  std::shared_ptr<const void> data_;
};

enum class OptionKind : std::uint8_t { number, whole, on_off, choice, text };

struct OptionInfo {
  std::string name, unit, meaning, section;
  std::string paper, refined;  // its values in the two profiles
  OptionKind kind = OptionKind::text;
  double min = 0, max = std::numeric_limits<double>::infinity();  // for number and whole
  bool min_excluded = false;
  std::vector<std::string> choices = {};  // for choice
};

/// All options, by the names that `planescope options` lists.
class PLANESCOPE_API Options {
 public:
  /// "refined", or "paper" for the method as published.
  explicit Options(const std::string& profile = "refined");
  Options(const Options& other);
  Options& operator=(const Options& other);
  ~Options();
  /// Throws Error for an unknown name, suggesting the nearest one, or an invalid value.
  /// `max_range_m` also crops clouds, unless `range_for_clouds` was set.
  Options& set(const std::string& name, const std::string& value);
  Options& set(const std::string& name, double value);
  std::string get(const std::string& name) const;
  static std::vector<OptionInfo> all();

 private:
  friend struct detail::Access;
  struct Data;
  std::unique_ptr<Data> data_;
};

// Output.

/// Inclination of a surface: h up to 45 degrees from level, v above.
enum class Label : std::uint8_t { unknown = 0, h = 1, v = 2 };

/// Region that a plane covers, as polygons on it: (x, y) is origin + x u + y v.
struct Outline {
  using Ring = std::vector<Vec2>;  // the first corner is not repeated
  struct Part {
    Ring outer;  // counter-clockwise, seen against the normal
    /// clockwise; another surface was measured there, or through the plane
    std::vector<Ring> holes;
    std::vector<Ring> unknown;  // clockwise; nothing was measured there
  };
  Vec3 origin = {0, 0, 0}, u = {1, 0, 0}, v = {0, 1, 0};  // world
  std::vector<Part> parts;                                // largest first
  double area_m2 = 0;                                     // without holes and unknown areas

  Vec3 world(const Vec2& p) const {
    return {origin[0] + p[0] * u[0] + p[1] * v[0], origin[1] + p[0] * u[1] + p[1] * v[1],
            origin[2] + p[0] * u[2] + p[1] * v[2]};
  }
};

/// A plane in the world frame. Its normal points up (h) or toward the sensor (v).
struct Plane {
  int id = 0;  // from 1
  Label label = Label::unknown;
  Vec3 normal = {0, 0, 1};  // unit
  Vec3 centroid = {0, 0, 0};
  double offset_m = 0;       // normal . x of its points
  double tilt_deg = 0;       // 0: floor, 90: wall; NaN: gravity is unknown
  std::uint64_t points = 0;  // measurements on it
  std::uint64_t voxels = 0;
  double rms_m = 0;    // RMS distance of its measurements
  double area_m2 = 0;  // of the cells that contain points
  // How far the plane is from being lost, or joined with a neighbor at least as large; infinite if
  // no objective was minimized.
  double margin = std::numeric_limits<double>::infinity();
  bool undecided = false;  // the margin is below the threshold
  std::vector<Vec3> hull;  // convex, counter-clockwise, seen against the normal
  Outline outline;
  double height_m = std::numeric_limits<double>::quiet_NaN();  // above the floor; NaN: not level
  bool steppable = false;  // whether a foot can stand here; requires the option `foot_radius_m`
  std::string why_not;     // empty if steppable
};

/// Triangles, counter-clockwise, seen against the plane's normal.
struct Mesh {
  std::vector<Vec3> vertices;  // world
  std::vector<std::array<int, 3>> triangles;
};

/// Number of a frame's points by outcome.
struct Counts {
  std::uint64_t points = 0;  // in the image or cloud
  std::uint64_t no_measurement = 0, invalid = 0, beyond_range = 0, outside_cube = 0;
  std::uint64_t kept = 0;    // the rest, which is segmented
  std::uint64_t voxels = 0;  // that contain the kept points
};

/// Processing time of a frame, split as in Table IV of the paper.
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
  /// By id - 1. Outlines, heights and footholds are computed on first use.
  const std::vector<Plane>& planes() const&;
  std::vector<Plane> planes() &&;
  /// Plane id of each pixel [height * width] or point; 0: none.
  View<std::int32_t> plane_of() const&;
  View<std::int32_t> plane_of() && = delete;
  /// Label of each pixel or point by the classifier.
  View<Label> label_of() const&;
  View<Label> label_of() && = delete;
  /// Position of each pixel or point in the world; NaN: not measured.
  std::vector<Vec3> points() const;
  /// Region covered by a plane, without its holes. Throws Error if there is no such id.
  Mesh mesh(int id) const;
  const Gravity& gravity() const&;
  Gravity gravity() &&;
  Transform T_world_sensor() const;
  Counts counts() const;
  Timings timings() const;
  /// planes.json as `planescope segment` writes it, including flights of stairs, kerbs, and ramps.
  std::string json() const;
  /// Another format: "geojson", "obj", "ply", "planar-terrain", "csv" or "svg".
  std::string text(const std::string& format) const;

 private:
  friend struct detail::Access;
  Result() = default;
  std::shared_ptr<const detail::ResultData> data_;
};

enum class EventType : std::uint8_t {
  visit,   // a node is taken from the queue
  decide,  // a node is settled; value: e_n if it was computed
  found,   // a node's candidate founds a plane
  merge,   // a node's candidate joins `plane`; value: |n . dmu| [m]
  assign,  // a leftover point is assigned to `plane`; value: distance [m]
  drop,    // a leftover point remains without a plane
  refine,  // the objective joined, changed or dropped `plane`
};

/// One decision. -1: not applicable.
struct Event {
  EventType type;
  std::uint8_t node_case;  // for decide: 1 to 4, the paper's cases I to IV
  std::uint8_t stage;      // that decided: index into Trace::stages()
  Label label;             // of the candidate
  std::int32_t node;       // index into Trace::nodes()
  std::int32_t plane;      // in order of founding, not the final id
  std::int32_t other;      // second plane
  std::int32_t point;      // voxel
  float value;
};

/// A node of the octree. Steps are numbers of events; kNever: does not happen.
struct Node {
  static constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();
  std::int32_t parent = -1;
  int depth = 0;
  std::uint8_t node_case = 0;  // case in which it was settled
  std::uint32_t voxels = 0, voxels_h = 0;
  /// Corners of its cell, world. Bit 0 of an index is set for greater x or pixel u, bit 1 for
  /// greater y or pixel v, bit 2 for greater z or farther from the camera.
  std::array<Vec3, 8> corners = {};
  std::int32_t queued = kNever, visited = kNever, decided = kNever;
};

/// The decisions that led to the planes of a frame: step k is the state after k events.
class PLANESCOPE_API Trace {
 public:
  int steps() const { return static_cast<int>(events().size()); }
  View<Event> events() const&;
  View<Event> events() && = delete;
  /// "criteria", "merge", "assign", and "join" to "list" for the stages of the objective.
  static std::vector<std::string> stages();
  /// One line that describes the event leading to step k; 1 <= k <= steps().
  std::string describe(int step) const;
  std::vector<Node> nodes() const;  // breadth-first, the root first
  /// Plane of each pixel or point at a step, in order of founding; -1: none.
  std::vector<std::int32_t> plane_of(int step) const;
  std::int32_t plane_of(int step, std::size_t i) const;  // of a single pixel or point
  /// Final id of a plane given in order of founding; 0: not in the result.
  int id_of(int plane) const;
  Result result() const;

 private:
  friend struct detail::Access;
  Trace() = default;
  std::shared_ptr<const detail::TraceData> data_;
};

/// Options and the classifier that they name, ready to segment frames.
class PLANESCOPE_API Segmenter {
 public:
  /// Results do not depend on the number of threads.
  explicit Segmenter(const Options& options = Options(), int threads = 1);
  Result segment(const Frame& frame) const;
  /// Like segment(), recording every decision. Throws Error if the option `method` is not "ours".
  Trace trace(const Frame& frame) const;

 private:
  friend struct detail::Access;
  std::shared_ptr<const detail::SegmenterData> data_;
};

/// For a single frame; keep a Segmenter for many.
inline Result segment(const Frame& frame, const Options& options = Options()) {
  return Segmenter(options).segment(frame);
}

}  // namespace v0
}  // namespace planescope
