#pragma once

// Recordings with random access to their frames, and gravity that a user picked for them.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/frame_match.hpp"

namespace planescope::io {

/// Settings by the user; they override the recording's files.
struct RecordingOptions {
  std::optional<std::array<double, 4>> intrinsics;  // fx fy cx cy of the depth image [px]
  std::optional<double> depth_unit_m;               // meters per count
  std::string instance_field = {};  // clouds: field with plane ids, instead of `instance`
  std::string topic = {};           // bags: the topic to read; empty: the first with depth
  /// Allow "-": read standard input to its end and keep it in memory.
  bool standard_input = false;
  /// Leave unknown intrinsics at zero (for inspection); otherwise they are an Error.
  bool intrinsics_may_lack = false;
  /// Off: skip color, which makes reading faster.
  bool color = true;
};

/// Hint in messages about unknown intrinsics.
inline constexpr const char* kHowToGiveIntrinsics = "specify them with --intrinsics FX,FY,CX,CY";

/// What is wrong with RecordingInfo::ignored_calibration, for people.
inline constexpr const char* kNotACalibration =
    "not a supported calibration; expected JSON, OpenCV XML, or text with 4, 7, 9, or 16 numbers";

/// Facts about a recording, for `info`, for reports and for the one-line summary on load.
struct RecordingInfo {
  std::filesystem::path path;
  std::string format;         // "RealSense SDK bag", "folder", "RealSense Viewer raw", ...
  std::string device;         // from the file; may be empty
  int width = 0, height = 0;  // depth image; 0 for clouds
  double depth_unit_m = 0;
  std::string depth_unit_source;  // "bag topic .../Depth Units", "assumed (RealSense default)", ...
  bool rounded = false;           // recorded in meters (32FC1), rounded to the unit
  Intrinsics intrinsics;
  std::string intrinsics_source;                 // file or topic name, "option"; empty: unknown
  std::vector<std::string> ignored_calibration;  // calibration files that are not understood
  std::string times_source;         // source of frame times: a file, "file names"; empty: none
  std::string topic;                // the topic chosen by RecordingOptions::topic
  std::vector<std::string> topics;  // bags: topics with frames; the first is read
  bool has_color = false;
  std::string color_note;             // "aligned", "projected by extrinsics", "none", ...
  std::vector<std::string> warnings;  // data loss and anomalies, one line each, with counts
  /// Frames found damaged when the recording was opened, and why: reading one throws this. Opening
  /// checks only the ends of files, so reading other frames may fail as well.
  std::map<int, std::string> damaged;

  /// Clouds need no camera.
  bool knows_camera() const { return width == 0 || !intrinsics_source.empty(); }
};

/// A recording with random access to its frames. Reading is const and thread-safe.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual const RecordingInfo& info() const = 0;
  virtual int frame_count() const = 0;
  /// Throws Error if frame i cannot be read; 0 <= i < frame_count().
  virtual Frame frame(int i) const = 0;
  /// Frame::timestamp_s of frame i. Readers override it if they need not read the frame.
  virtual double timestamp_s(int i) const { return frame(i).timestamp_s; }
  /// Frame::T_world_camera of frame i. Readers with poses override it.
  virtual std::optional<Pose> T_world_camera(int /*i*/) const { return std::nullopt; }
  /// SHA-256 of the raw bytes of frame i: its depth image as little-endian counts, or as floats if
  /// it was recorded in meters; or the cloud's coordinates. Ties labels to the data they were drawn
  /// on.
  virtual std::string frame_hash(int i) const = 0;
};

/// Opens any format that planescope reads (ROS 1 or 2 bag, folder of PNGs, Viewer .raw, clouds, "-"
/// for standard input), detected from the content. Throws Error with one line on anything else, or
/// if all frames are damaged. A sidecar adds missing facts (gravity, intrinsics, unit):
/// `<recording>.planescope.json` beside the recording, or `planescope.json` or `gravity.json` in a
/// folder. `Sidecar` in readers.hpp lists its keys.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path,
                                          const RecordingOptions& options = {});

/// Formats of open_recording() for usage texts: "Recording: a .bag, ..., or a .ply or .pcd cloud",
/// or "Recordings, each a .bag, ...".
std::string recordings_text(bool many, bool clouds = true);

/// Frames that arrive on standard input: docs/formats.md, "Standard input". frame_count() is the
/// number of frames that have arrived.
class FrameStream : public Recording {
 public:
  /// Waits for the next frame. Returns false at the end of the stream and on a stop. Throws Error
  /// naming the frame if it is truncated or invalid.
  virtual bool wait_for_frame(const std::stop_token& stop) = 0;
};
/// Reads the header of a stream from a file descriptor. Keeps only the last frame, or all. Throws
/// Error.
std::unique_ptr<FrameStream> open_stream(int descriptor,
                                         const RecordingOptions& options,
                                         bool keeps_all);

/// Finds frames by their pixels, in a recording to which frames were added or from which frames
/// were removed since the numbers in `wanted` were stored. Returns their present numbers; nullopt
/// if no frame has these pixels. Reads the wanted frames and, if numbers have shifted, all others.
std::vector<std::optional<int>> find_frames(const Recording& recording,
                                            std::span<const FrameIdentity> wanted);

/// The same recording with frames completed by `change`, which may run several times concurrently
/// and may throw Error.
std::shared_ptr<const Recording> with_changed_frames(std::shared_ptr<const Recording> recording,
                                                     std::function<void(Frame&)> change);

// ---- Gravity that a user picked by clicking floors or walls. It is stored in the folder of the
// recording's labels, never in the recording, and every command reads it: docs/formats.md ----

/// A direction derived from clicks on one frame.
struct PickedDirection {
  Vec3d direction = Vec3d::UnitY();  // of gravity: unit vector, in the frame of the sensor or cloud
  std::vector<Vec3d> walls;          // unit normals it was derived from; empty: from a floor
  int frame = 0;                     // the clicked frame ...
  std::string frame_sha256;          // ... and its Recording::frame_hash()
  std::string note;                  // one phrase for display

  bool operator==(const PickedDirection&) const = default;
};

struct PickedGravity {
  std::optional<PickedDirection> recording;  // for all frames without their own
  std::map<int, PickedDirection> frames;

  bool empty() const { return !recording && frames.empty(); }
  const PickedDirection* of(int frame) const;  // null: not picked
  bool operator==(const PickedGravity&) const = default;
};

/// Reads DIR/gravity.json, schema planescope.gravity/1. Empty if there is no such file. Throws
/// Error naming the file and the problem, also if it was picked on another recording.
PickedGravity read_picked_gravity(const std::filesystem::path& label_dir,
                                  const Recording& recording);
/// Replaces the file, or removes it if nothing is picked. Throws Error.
void write_picked_gravity(const std::filesystem::path& label_dir, const PickedGravity& picked);

/// Applies to frames without gravity: a sidecar and an IMU take precedence.
void apply_picked_gravity(const PickedGravity& picked, Frame& frame);

/// The same recording with picked gravity applied to its frames.
std::shared_ptr<const Recording> with_picked_gravity(std::shared_ptr<const Recording> recording,
                                                     PickedGravity picked);

}  // namespace planescope::io
