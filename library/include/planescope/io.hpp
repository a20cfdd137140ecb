#pragma once

// Reads recordings: RealSense and ROS bags (1 and 2), folders of PNGs, RealSense Viewer .raw,
// clouds. Also makes maps of them.

#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // planescope itself has types of the same names
namespace v0 {
#else
inline namespace v0 {
#endif
/// Settings for a recording that override its files.
struct RecordingOptions {
  std::optional<std::array<double, 4>> intrinsics;  // fx fy cx cy of the depth image [px]
  std::optional<double> depth_unit_m;               // meters per count
  bool color = true;                                // false: depth only, which is faster
};

struct RecordingInfo {
  std::string path;
  std::string format;       // "RealSense SDK bag", "folder", ...
  std::string device;       // from the file; may be empty
  Camera camera;            // of depth images; width 0: clouds
  double depth_unit_m = 0;  // meters per count
  bool has_color = false;
  std::vector<std::string> warnings;  // losses and oddities, one line each
};

struct Map;
struct MapOptions;

/// A recording, opened once, whose frames can be read in any order. Never writes to it.
class PLANESCOPE_API Recording {
 public:
  explicit Recording(const std::string& path, const RecordingOptions& options = {});
  RecordingInfo info() const;
  int size() const;  // number of frames
  Frame operator[](int i) const;
  /// Frame::timestamp_s() of a frame, usually without reading it.
  double timestamp_s(int i) const;

  /// Valid as long as its recording.
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
  std::string poses;        // file: TUM, KITTI, Open3D's .log or .json; empty: poses from the
                            // recording or, without any, from its images
  double window_m = 0;      // edge of the map's cube around the camera; 0: unlimited
  std::vector<int> frames;  // ascending; empty: all
  std::map<int, Transform> T_world_camera;  // by frame, instead of a file of poses
};

/// Planes in the world, and the tracks that connect them to the planes of frames. World: z up [m].
struct Map {
  std::string map_json, tracks_json, poses_tum;  // as `planescope map` writes them, byte for byte
  std::vector<int> pose_frames;                  // frames with a known pose
  std::vector<Transform> T_world_camera;         // of pose_frames
  std::vector<std::string> warnings;             // one line each
  // planes/000000.png by frame: 16 bits, with the plane id per pixel that `tracks_json` uses. Empty
  // for methods that do not find planes on pixels; these find the same planes again.
  std::map<int, std::string> planes_png;
};
/// The result does not depend on the segmenter's threads. Throws Error if the recording contains
/// clouds or no frame has a pose.
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

/// A map of frames as they arrive, each with the camera's pose in a world whose z points up.
/// Earlier frames help to find the planes of later ones. Copies share the map; threads take turns.
class PLANESCOPE_API Mapper {
 public:
  /// `window_m`: edge of the map's cube around the camera; 0: unlimited.
  explicit Mapper(const Segmenter& segmenter = Segmenter(), double window_m = 0);
  /// Throws Error if the frame is a cloud, the pose is not rigid, or the first frame clearly shows
  /// that gravity does not point along -z.
  MappedFrame add(const Frame& frame, const Transform& T_world_camera);
  int size() const;  // number of frames
  /// The map of all frames so far, numbered in the order of add(), with an empty planes_png. Throws
  /// Error if there are no frames.
  Map map() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace v0
}  // namespace planescope
