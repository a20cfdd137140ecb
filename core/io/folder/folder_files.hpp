#pragma once

// What a folder of images has in its files: which image is which, when it was taken, what the
// accelerometer measured, and calibration. But for camera_choices() and what follows it, internal
// to core/io.

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/readers.hpp"

namespace planescope::io {

/// Which images of a folder are depth, and which colour belongs to each.
struct FolderLayout {
  std::vector<std::filesystem::path> depth;  // in natural order
  std::vector<std::filesystem::path> color;  // one per depth image, empty path where none
  bool tum = false;                          // depth.txt and rgb.txt beside the folders
  /// Per depth image, its time from a list or a file name: its own, else that of its color image.
  std::vector<std::optional<double>> time_s;
  std::string times_source;  // "depth.txt", "file names"; empty: unknown
  std::vector<std::string> warnings;
  bool has_color() const;
};

/// Depth are PNGs or, before them, dumps. Looks for depth/ with color/ or rgb/, else for names such
/// as 000_depth.png and 000_color.png in the folder itself, else for 16-bit grey PNGs there. No
/// depth images: an empty layout. Throws Error where a list of images beside them is damaged.
FolderLayout find_folder_layout(const std::filesystem::path& folder);

/// Whether its name is that of depth counts without a header, as rs-convert -r of the RealSense SDK
/// writes them: PREFIX_Depth_TIME.raw.
bool is_depth_dump(const std::filesystem::path& path);

/// A point of time in a file name: the last number of it when it has at least ten digits before
/// the point, the first not 0 (seconds, milli-, micro- or nanoseconds since 1970). [s]
std::optional<double> timestamp_in_name(const std::filesystem::path& path);

// ---- Times and gravity: text files beside the images, as TUM's RGB-D recordings have them ----

/// The file NAME in the folder of the images, or beside a folder named `depth`; empty: none.
std::filesystem::path file_beside_images(const std::filesystem::path& folder, const char* name);

/// What lists of images say of their times.
struct ListedTimes {
  struct Time {
    double s = 0;
    std::string list;  // file name
  };
  std::map<std::filesystem::path, Time> of_image;  // images as the caller names them
  std::vector<std::string> warnings;
};

/// Reads depth.txt and rgb.txt (`timestamp file` a line) and associations.txt (two of these a line,
/// either first). A file that names none of the images is not such a list. Throws Error naming file
/// and line where another line of a list is damaged, or gives an image a second time.
ListedTimes listed_times(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& depth,
                         const std::vector<std::filesystem::path>& color);

/// The times of poses.tum, whose line i is of frame i; empty where there is no such file, its times
/// are all 0, or, with a warning, where it has another number of poses. Throws Error naming file
/// and line.
std::vector<double> times_of_poses(const std::filesystem::path& folder,
                                   std::size_t frames,
                                   std::vector<std::string>& warnings);

/// accelerometer.txt: `timestamp ax ay az` [s, m/s2], as TUM publishes it of the Kinect.
class Accelerometer {
 public:
  /// Without samples where there is no such file. Throws Error naming file and line.
  explicit Accelerometer(const std::filesystem::path& folder);

  /// Whether there are samples about `time_s`.
  bool covers(double time_s) const { return !about(time_s).empty(); }
  /// In the frame of the camera, from the mean of the samples about `time_s`; nullopt where there
  /// is none, or the mean is not near 1 g.
  std::optional<Gravity> gravity_at(double time_s) const;

  static constexpr const char* kFile = "accelerometer.txt";
  /// Samples count that are so near to the frame [s]. Shorter windows let the shaking of a hand
  /// through, longer ones its turns.
  static constexpr double kReach_s = 0.2;

 private:
  struct Sample {
    double time_s = 0;
    Vec3d m_s2;  // axes of the camera
  };
  std::span<const Sample> about(double time_s) const;

  std::vector<Sample> samples_;  // by time
};

// ---- Calibration ----

struct CameraFiles {
  CameraFacts depth;
  std::optional<Intrinsics> color;  // only where a file tells them apart from those of depth
  std::optional<Pose> T_color_depth;
  std::vector<std::string> ignored;  // files named as calibrations that are none
};

/// Reads what calibration the folder has: JSON with `intrinsic_matrix` (and `depth_scale`), OpenCV
/// XML, or a text file of numbers. Throws Error when a file named as intrinsics is damaged.
CameraFiles find_camera_files(const std::filesystem::path& folder);

// One per format; nullopt where the file is of another kind.
std::optional<CameraFacts> camera_from_json(const std::filesystem::path& path);
std::optional<CameraFiles> camera_from_opencv_xml(const std::filesystem::path& path);
std::optional<CameraFacts> camera_from_text(const std::filesystem::path& path);

// ---- Intrinsics for a recording whose files have none ----

/// Intrinsics that may be those of a recording.
struct CameraChoice {
  std::string name;  // the file that has them, or the camera
  Intrinsics intrinsics;
  double depth_unit_m = 0.001;  // m per count
  bool from_file = false;
};

/// Intrinsics for depth images of the recording's size: those in files of neighboring folders
/// first, then nominal values of common cameras. Damaged files are skipped.
std::vector<CameraChoice> camera_choices(const RecordingInfo& info);

/// The camera whose nominal values these are; empty: none.
std::string nominal_camera(const Intrinsics& intrinsics);

/// `<recording>.planescope.json` beside the recording.
std::filesystem::path camera_file(const RecordingInfo& info);
/// Stores the recording's intrinsics and depth unit in camera_file(), and keeps what else that
/// file has. Throws Error.
void remember_camera(const RecordingInfo& info);

}  // namespace planescope::io
