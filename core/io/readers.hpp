#pragma once

// What the readers of the single formats share. Internal to core/io.

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

/// What lies beside a recording and says what its files cannot: `planescope.json` or
/// `gravity.json` in a folder, `<file>.planescope.json` beside a single file. All keys optional:
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
  std::filesystem::path path;  // empty where there is none
  std::optional<Intrinsics> intrinsics;
  std::string intrinsics_source;  // name of the file that has them
  std::optional<double> depth_unit_m;
  std::optional<Vec3d> gravity;  // unit vector, for all frames that have none of their own
  std::optional<bool> color_aligned;
  std::optional<Intrinsics> color_intrinsics;  // of colour on pixels of its own, with ...
  Pose T_color_depth = Pose::Identity();       // ... where its camera stands
  std::vector<FrameFacts> frames;
  std::unordered_map<std::string, std::size_t> frame_of;  // by name; of equal ones the first
};

/// The facts in an object of a document; `path`: of the document. Throws Error.
Sidecar sidecar_of(const JsonPlace& place, const std::filesystem::path& path);

/// What the sidecar says of the frame with this name; null: nothing.
const Sidecar::FrameFacts* facts_of(const Sidecar& sidecar, const std::string& name);

/// Intrinsics as sidecars have them.
nlohmann::ordered_json intrinsics_json(const Intrinsics& intrinsics);

/// A pose as sidecars have it: tx ty tz qx qy qz qw.
std::array<double, 7> pose_numbers(const Pose& pose);

/// `<recording>.planescope.json`, whether or not it exists.
std::filesystem::path sidecar_beside(const std::filesystem::path& recording);
/// Reads the sidecar of a recording, empty if there is none. A folder may have one beside it and
/// one inside; each key comes from the one beside, if that has it. Throws Error that names the
/// sidecar and the key if a value cannot be used.
Sidecar read_sidecar(const std::filesystem::path& recording);
/// Puts the sidecar's gravity and timestamp into a frame.
void apply_sidecar(const Sidecar& sidecar, Frame& frame);

/// The sidecar's time of the frame with this name, else its `own`.
double time_of_frame(const Sidecar& sidecar, const std::string& name, double own_s);

/// Whether the sidecar gives any frame a time other than 0.
bool tells_times(const Sidecar& sidecar);

/// Gravity from the mean of accelerometer samples, in the depth camera's frame: at rest they
/// measure the reaction to gravity, so things fall along its negative. `within_s`: how far in time
/// samples are from the frame. nullopt where the mean is not near 1 g: shaken, or damaged.
std::optional<Gravity> gravity_of_accelerometer(const Vec3d& mean_m_s2,
                                                std::size_t samples,
                                                double within_s);

/// What the files of a recording themselves say about the depth camera.
struct CameraFacts {
  std::optional<Intrinsics> intrinsics;
  std::string intrinsics_source;
  std::optional<double> depth_unit_m;
  std::string depth_unit_source;
};

/// Settles intrinsics and depth unit of `info` (path, width and height already set): option, then
/// sidecar, then file, then the RealSense default for the unit. Throws Error when there are no
/// intrinsics, naming --intrinsics, or when they are for another image size.
void settle_camera(const RecordingOptions& options,
                   const Sidecar& sidecar,
                   const CameraFacts& facts,
                   RecordingInfo& info);

/// Sets the distortion from a model's name and its coefficients. Returns false when the model is
/// not supported although its coefficients are not zero: then none is set.
bool set_distortion(const std::string& model,
                    const std::vector<double>& coefficients,
                    Intrinsics& intrinsics);

std::string sha256_of_depth(const Image16& depth);

// One per format; each throws Error when the path does not hold what it reads.
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

/// At the .raw or .csv given, or all in the folder given.
std::vector<RawFile> viewer_raw_files(const std::filesystem::path& path);

// What kinds of files lie where.

/// File extension in lower case, with its dot.
std::string extension(const std::filesystem::path& path);

/// Orders names as people do: 2 before 10.
bool natural_less(const std::string& a, const std::string& b);

/// Regular files in a folder, hidden ones left out, in natural order. Throws Error naming the
/// folder when it cannot be listed.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder);
/// All .ply and .pcd files in a folder, then those in the folders below it. Where there is none,
/// all files of the formats that were added, in the same order.
std::vector<std::filesystem::path> cloud_files_under(const std::filesystem::path& folder);

/// Adds a warning if color that is called aligned with depth has another field of view.
void add_view_warning(int width, double focal_px, RecordingInfo& info);
/// Warnings about intrinsics that no real camera has, files of intrinsics that are not understood,
/// and, if it is `of_color`, color that is not aligned with depth.
std::vector<std::string> camera_warnings(const RecordingInfo& info, bool of_color);
/// Warnings if most of the frame's depth is nearer than 5 cm or farther than 100 m, and if color
/// that is called aligned with depth has another size.
std::vector<std::string> frame_warnings(const RecordingInfo& info, const Frame& frame);

}  // namespace planescope::io
