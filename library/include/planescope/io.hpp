#pragma once

// Recordings: RealSense and ROS bags (1 and 2), folders of PNGs, RealSense Viewer .raw, clouds.

#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // which has types of the same names, in planescope itself
namespace v0 {
#else
inline namespace v0 {
#endif
/// What the caller says about a recording; wins over what its files say.
struct RecordingOptions {
  std::optional<std::array<double, 4>> intrinsics;  // fx fy cx cy of the depth image [px]
  std::optional<double> depth_unit_m;               // metres per count
  bool color = true;                                // false: depth alone, and quicker
};

struct RecordingInfo {
  std::string path;
  std::string format;       // "RealSense SDK bag", "folder", ...
  std::string device;       // as the file says, or empty
  Camera camera;            // of depth images; width 0: clouds
  double depth_unit_m = 0;  // metres per count
  bool has_color = false;
  std::vector<std::string> warnings;   // what was lost or odd, one line each
  std::map<int, std::string> damaged;  // frames found damaged on opening, and why; others may be
};

struct Map;
struct MapOptions;

/// Opened once, its frames read in any order. Never written to.
class PLANESCOPE_API Recording {
 public:
  explicit Recording(const std::string& path, const RecordingOptions& options = {});
  RecordingInfo info() const;
  int size() const;  // frames
  /// Throws Error where the frame is damaged.
  Frame operator[](int i) const;
  /// Frame::timestamp_s() of one, mostly without reading it.
  double timestamp_s(int i) const;

  /// Of a recording that outlives it.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Frame;
    using difference_type = std::ptrdiff_t;
    using pointer = const Frame*;
    using reference = Frame;

    Iterator(const Recording* recording, int i) : recording_(recording), i_(i) {}
    Frame operator*() const { return (*recording_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    Iterator operator++(int) { return {recording_, i_++}; }
    bool operator==(const Iterator& other) const { return i_ == other.i_; }
    bool operator!=(const Iterator& other) const { return i_ != other.i_; }

   private:
    const Recording* recording_;
    int i_;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size()}; }

 private:
  friend PLANESCOPE_API Map make_map(const Recording& recording,
                                     const Segmenter& segmenter,
                                     const MapOptions& options);
  std::shared_ptr<const void> data_;
};

struct MapOptions {
  std::string poses;        // a file: TUM, KITTI, Open3D's .log or .json; empty: as the recording
                            // says, else from its images
  double window_m = 0;      // edge of the cube about the camera that the map is held in; 0: none
  std::vector<int> frames;  // ascending; empty: all
  std::map<int, Transform> T_world_camera;  // by frame, instead of a file of poses
  bool skip_damaged = false;  // else make_map() throws where a frame cannot be read or processed
};

/// Planes of the world, and which plane of which frame is which. World: z up [m].
struct Map {
  std::string map_json, tracks_json, poses_tum;  // as `planescope map` writes them, byte by byte
  std::vector<int> pose_frames;                  // whose pose is known
  std::vector<Transform> T_world_camera;         // of these
  std::vector<std::string> told;                 // what was odd, one line each
  // By frame, the file planes/000000.png: 16 bit, per pixel the id of the plane that `tracks_json`
  // counts. Empty for methods that do not find planes on pixels: those find the same ones again.
  std::map<int, std::string> planes_png;
};
/// The same for any number of the segmenter's threads. Throws Error where the recording is of
/// clouds, or no frame has a pose.
PLANESCOPE_API Map make_map(const Recording& recording,
                            const Segmenter& segmenter = Segmenter(),
                            const MapOptions& options = MapOptions());

/// One frame of a Mapper.
struct MappedFrame {
  Result result;
  std::vector<int> tracks;   // by plane id - 1; 0: none
  Transform T_world_camera;  // aligned with the map so far
  bool set_aside = false;    // depth and pose do not fit the map; the map ignores the frame
};

/// A map of frames as they arrive, each with the pose of its camera in a world whose z points up.
/// Earlier frames help to find the planes of later ones. Copies share the map; threads take turns.
class PLANESCOPE_API Mapper {
 public:
  /// `window_m`: edge of the cube about the camera that the map is held in; 0: no limit.
  explicit Mapper(const Segmenter& segmenter = Segmenter(), double window_m = 0);
  /// Throws Error if the frame is a cloud, the pose is not rigid, or the first frame clearly shows
  /// that gravity does not point along -z.
  MappedFrame add(const Frame& frame, const Transform& T_world_camera);
  int size() const;  // frames
  /// The map of all frames so far, numbered in the order of add(). Error: there are none.
  /// Its planes_png is empty.
  Map map() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace v0
}  // namespace planescope
