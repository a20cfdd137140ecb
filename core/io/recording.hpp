#pragma once

// Recordings: opened once, frames read at random; and gravity that a user picked for them.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::io {

/// What the user says about a recording; wins over what its files say.
struct RecordingOptions {
  std::optional<std::array<double, 4>> intrinsics;  // fx fy cx cy of the depth image [px]
  std::optional<double> depth_unit_m;               // metres per count
  std::string instance_field = {};  // clouds: where plane ids stand, instead of `instance`
  std::string topic = {};           // bags: the topic to read; empty: the first with depth
  /// "-" may be opened: standard input is read to its end and kept in memory.
  bool standard_input = false;
  /// Folders: a damaged frame is an Error when it is read, not when the recording is opened, as
  /// long as another one is whole.
  bool damaged_frames_later = false;
  /// Intrinsics that nobody knows stay zero, for who only looks at what is there; else an Error.
  bool intrinsics_may_lack = false;
  /// Off: depth alone, for who does not look at colour; frames come without it, and quicker.
  bool color = true;
};

/// What to do where intrinsics are not known, as a hint for people.
inline constexpr const char* kHowToGiveIntrinsics = "give them with --intrinsics FX,FY,CX,CY";

/// What is wrong with RecordingInfo::ignored_calibration, for people.
inline constexpr const char* kNotACalibration =
    "not a calibration that planescope reads; expected JSON, OpenCV XML, or text of 4, 7, 9 or 16 "
    "numbers";

/// Facts about a recording, for `info`, for reports and for the one-line summary on load.
struct RecordingInfo {
  std::filesystem::path path;
  std::string format;         // "RealSense SDK bag", "folder", "RealSense Viewer raw", ...
  std::string device;         // as the file says, or empty
  int width = 0, height = 0;  // depth image; 0 for clouds
  double depth_unit_m = 0;
  std::string depth_unit_source;  // "bag topic .../Depth Units", "assumed (RealSense default)", ...
  bool rounded = false;           // depth was recorded in meters (32FC1) and is rounded to the unit
  Intrinsics intrinsics;
  std::string intrinsics_source;  // file or topic name, "option"; empty: nobody knows them
  std::vector<std::string> ignored_calibration;  // files named as calibrations, not understood
  std::string times_source;  // where frame times come from: a file, "file names"; empty: none
  std::string topic;         // the topic chosen by RecordingOptions::topic
  std::vector<std::string> topics;  // bags: topics with frames, the one that is read first
  bool has_color = false;
  std::string color_note;             // "aligned", "projected by extrinsics", "none", ...
  std::vector<std::string> warnings;  // what was lost or odd, one line each, with counts

  /// Clouds need no camera.
  bool knows_camera() const { return width == 0 || !intrinsics_source.empty(); }
};

/// A recording: opened once, frames read at random. Reading is const and thread-safe.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual const RecordingInfo& info() const = 0;
  virtual int frame_count() const = 0;
  /// Throws Error if frame i cannot be read; 0 <= i < frame_count().
  virtual Frame frame(int i) const = 0;
  /// Frame::timestamp_s of frame i; readers that know it without reading the frame say so.
  virtual double timestamp_s(int i) const { return frame(i).timestamp_s; }
  /// Frame::T_world_camera of frame i; readers that know it without reading the frame say so, and
  /// others have none.
  virtual std::optional<Pose> T_world_camera(int /*i*/) const { return std::nullopt; }
  /// SHA-256 of the raw bytes that make frame i: its depth image as little-endian counts or, where
  /// it was recorded in meters, floats; or the cloud's coordinates. Ties labels to the data they
  /// were drawn on.
  virtual std::string frame_hash(int i) const = 0;
};

/// Opens any format that planescope reads (bag of ROS 1 or 2, folder of PNGs, Viewer .raw, clouds,
/// "-" for standard input), found out from the content. Throws Error with one line on anything
/// else. A sidecar adds what the files lack (gravity, intrinsics, unit):
/// `<recording>.planescope.json` beside it, or `planescope.json` or `gravity.json` in a folder; its
/// keys are listed at `Sidecar` in readers.hpp.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path,
                                          const RecordingOptions& options = {});

/// What open_recording() reads, for usage texts: "Recording: a .bag, ..., or a .ply or .pcd cloud",
/// or "Recordings, each a .bag, ...".
std::string recordings_text(bool many, bool clouds = true);

/// Frames that arrive on standard input: docs/formats.md, "Standard input". Its frame_count() is
/// the number that has arrived.
class FrameStream : public Recording {
 public:
  /// Waits for the next frame. False at the end of the stream, and on a stop. Throws Error naming
  /// the frame where it is cut or invalid.
  virtual bool wait_for_frame(const std::stop_token& stop) = 0;
};
/// Reads the header of a stream from a file descriptor. Keeps the last frame alone, or all. Throws
/// Error.
std::unique_ptr<FrameStream> open_stream(int descriptor,
                                         const RecordingOptions& options,
                                         bool keeps_all);

/// The same recording; `change`, of which several may run at once, adds to each frame what is known
/// of it elsewhere, and may throw Error.
std::shared_ptr<const Recording> with_changed_frames(std::shared_ptr<const Recording> recording,
                                                     std::function<void(Frame&)> change);

// ---- Gravity that a user picked by clicking floors or walls. It lies in the folder of the
// recording's labels, never in the recording, and every command reads it again: docs/formats.md
// ----

/// The direction that follows from clicks on one frame.
struct PickedDirection {
  Vec3d direction = Vec3d::UnitY();  // in which things fall: unit, sensor's or cloud's own frame
  std::vector<Vec3d> walls;          // the normals that it follows from, unit; empty: from a floor
  int frame = 0;                     // where it was clicked ...
  std::string frame_sha256;          // ... Recording::frame_hash() of it
  std::string note;                  // one phrase for people

  bool operator==(const PickedDirection&) const = default;
};

struct PickedGravity {
  std::optional<PickedDirection> recording;  // of all frames that have none of their own
  std::map<int, PickedDirection> frames;

  bool empty() const { return !recording && frames.empty(); }
  const PickedDirection* of(int frame) const;  // null: nothing was picked
  bool operator==(const PickedGravity&) const = default;
};

/// DIR/gravity.json, schema planescope.gravity/1. None where there is no such file. Throws Error
/// naming the file and what is wrong with it, also where it was picked on another recording.
PickedGravity read_picked_gravity(const std::filesystem::path& label_dir,
                                  const Recording& recording);
/// Replaces the file, or removes it where nothing is picked. Throws Error.
void write_picked_gravity(const std::filesystem::path& label_dir, const PickedGravity& picked);

/// Where the recording itself says nothing: a sidecar and an IMU go before it.
void apply_picked_gravity(const PickedGravity& picked, Frame& frame);

/// The same recording, its frames with what was picked.
std::shared_ptr<const Recording> with_picked_gravity(std::shared_ptr<const Recording> recording,
                                                     PickedGravity picked);

}  // namespace planescope::io
