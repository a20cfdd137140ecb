#pragma once

// Code shared by the readers of all formats. Internal to core/io.

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/io/recording.hpp"

namespace planescope {
class JsonPlace;
}

namespace planescope::io {

/// Facts about a recording that its files lack: `planescope.json` or `gravity.json` in a folder,
/// `<file>.planescope.json` beside a single file. All keys are optional:
///   {"schema": "planescope.recording/1",
///    "intrinsics": {"width", "height", "fx", "fy", "cx", "cy", "distortion": [k1,k2,p1,p2,k3]},
///    "depth_unit_m": 0.001, "gravity": [x, y, z], "color_aligned": true,
///    "color": {"intrinsics": {...}, "T_color_depth": [16 numbers, row by row]},
///    "frames": [{"name": "000000", "timestamp_s": 0.0, "gravity": [x, y, z],
///                "T_world_camera": [tx, ty, tz, qx, qy, qz, qw]}]}
struct Sidecar {
  struct FrameFacts {
    std::string name;  // file stem of the depth image
    std::optional<double> timestamp_s;
    std::optional<Vec3d> gravity;  // unit vector
    std::optional<Pose> T_world_camera;
  };
  std::filesystem::path path;  // empty if there is none
  std::optional<Intrinsics> intrinsics;
  std::string intrinsics_source;  // name of the file that contains them
  std::optional<double> depth_unit_m;
  std::optional<Vec3d> gravity;  // unit vector, for frames without their own
  std::optional<bool> color_aligned;
  std::optional<Intrinsics> color_intrinsics;  // color not aligned to depth, ...
  Pose T_color_depth = Pose::Identity();       // ... and its camera's pose
  std::vector<FrameFacts> frames;
  std::unordered_map<std::string, std::size_t> frame_of;  // by name; the first of equal names
};

/// Reads the facts in an object of a document. `path`: of the document. Throws Error.
Sidecar sidecar_of(const JsonPlace& place, const std::filesystem::path& path);

/// The sidecar's facts about the frame with this name; null: none.
const Sidecar::FrameFacts* facts_of(const Sidecar& sidecar, const std::string& name);

/// Intrinsics in the form of sidecars.
nlohmann::ordered_json intrinsics_json(const Intrinsics& intrinsics);

/// A pose in the form of sidecars: tx ty tz qx qy qz qw.
std::array<double, 7> pose_numbers(const Pose& pose);

/// `<recording>.planescope.json`, whether or not it exists.
std::filesystem::path sidecar_beside(const std::filesystem::path& recording);
/// Reads the sidecar of a recording; empty if there is none. A folder may have one beside it and
/// one inside; the one beside takes precedence for each key. Throws Error that names the sidecar
/// and the key if a value is invalid.
Sidecar read_sidecar(const std::filesystem::path& recording);
/// Copies the sidecar's gravity and timestamp to a frame.
void apply_sidecar(const Sidecar& sidecar, Frame& frame);

/// The sidecar's time of the frame with this name, else `own_s`.
double time_of_frame(const Sidecar& sidecar, const std::string& name, double own_s);

/// Whether the sidecar gives any frame a time other than 0.
bool has_times(const Sidecar& sidecar);

/// Gravity from the mean of accelerometer samples, in the depth camera's frame: at rest they
/// measure the reaction to gravity, so gravity is the negative of the mean. `within_s`: maximum
/// time between samples and frame. nullopt if the mean is not near 1 g: shaken, or damaged.
std::optional<Gravity> gravity_of_accelerometer(const Vec3d& mean_m_s2,
                                                std::size_t samples,
                                                double within_s);

/// Facts about the depth camera in the files of a recording.
struct CameraFacts {
  std::optional<Intrinsics> intrinsics;
  std::string intrinsics_source;
  std::optional<double> depth_unit_m;
  std::string depth_unit_source;
};

/// Sets intrinsics and depth unit of `info` (path, width and height already set): from the option,
/// then the sidecar, then the file, then the RealSense default for the unit. Throws Error that
/// names --intrinsics if there are no intrinsics, or if they are for another image size.
void settle_camera(const RecordingOptions& options,
                   const Sidecar& sidecar,
                   const CameraFacts& facts,
                   RecordingInfo& info);

/// Sets the distortion from a model's name and its coefficients. Returns false, and sets none, if
/// the model is not supported and its coefficients are not zero.
bool set_distortion(const std::string& model,
                    const std::vector<double>& coefficients,
                    Intrinsics& intrinsics);

std::string sha256_of_depth(const Image16& depth);

// One per format; each throws Error if the path does not contain that format.
std::unique_ptr<Recording> open_bag(const std::filesystem::path& path,
                                    const RecordingOptions& options);
std::unique_ptr<Recording> open_image_folder(const std::filesystem::path& path,
                                             const RecordingOptions& options);
std::unique_ptr<Recording> open_viewer_raw(const std::filesystem::path& path,
                                           const RecordingOptions& options);
std::unique_ptr<Recording> open_clouds(const std::filesystem::path& path,
                                       const RecordingOptions& options);

/// A depth snapshot of the RealSense Viewer.
struct RawFile {
  std::filesystem::path raw;
  std::filesystem::path csv;
};

/// The snapshot at a .raw or .csv file, or all snapshots in a folder.
std::vector<RawFile> viewer_raw_files(const std::filesystem::path& path);

// File names and kinds.

/// File extension in lower case, including the dot.
std::string extension(const std::filesystem::path& path);

/// Entries of a folder except hidden ones, in natural order. Throws Error naming the folder if it
/// cannot be listed.
std::vector<std::filesystem::path> entries_in(const std::filesystem::path& folder);
/// Natural order: 2 before 10.
bool natural_less(const std::string& a, const std::string& b);

/// Its regular files.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder);
/// All .ply and .pcd files in a folder, then those in its subfolders. If there are none, all files
/// of the added formats, in the same order.
std::vector<std::filesystem::path> cloud_files_under(const std::filesystem::path& folder);

/// Throws Error if the path is a folder, a pipe or a link to a missing file.
void expect_regular_file(const std::filesystem::path& path);
/// Stores the Error that check(i) throws for a frame in `info.damaged`. Throws the first one if all
/// frames are damaged.
void find_damaged_frames(std::size_t frames,
                         RecordingInfo& info,
                         const std::function<void(std::size_t)>& check);
/// Throws the Error that was stored for the frame, if any.
void expect_undamaged(const RecordingInfo& info, int i);

/// Adds a warning if color that is called aligned with depth has another field of view.
void add_view_warning(int width, double focal_px, RecordingInfo& info);
/// Warnings about implausible intrinsics, files of intrinsics that are not understood, and, if
/// `of_color`, color that is not aligned with depth.
std::vector<std::string> camera_warnings(const RecordingInfo& info, bool of_color);
/// Warnings if most of the frame's depth is nearer than 5 cm or farther than 100 m, and if color
/// that is called aligned with depth has another size.
std::vector<std::string> frame_warnings(const RecordingInfo& info, const Frame& frame);

}  // namespace planescope::io
