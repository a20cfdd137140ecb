#pragma once

// Contents of a folder of images: which image is which, timestamps, accelerometer samples, and
// calibration. Internal to core/io, except camera_choices() and the functions after it.

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/readers.hpp"

namespace planescope::io {

/// The depth images of a folder, and the color image for each.
struct FolderLayout {
  std::vector<std::filesystem::path> depth;  // in natural order
  std::vector<std::filesystem::path> color;  // one per depth image; empty path if there is none
  bool tum = false;                          // depth.txt and rgb.txt beside the folders
  /// Time of each depth image from a list or a file name: its own, else that of its color image.
  std::vector<std::optional<double>> time_s;
  std::string times_source;  // "depth.txt", "file names"; empty: unknown
  std::vector<std::string> warnings;
  bool has_color() const;
};

/// Depth images are PNGs, or dumps, which take precedence. Looks for depth/ with color/ or rgb/,
/// then for names such as 000_depth.png and 000_color.png in the folder itself, then for 16-bit
/// gray PNGs there. The layout is empty if there are no depth images. Throws Error if a list of
/// images beside them is damaged.
FolderLayout find_folder_layout(const std::filesystem::path& folder);

/// Whether the name is PREFIX_Depth_TIME.raw, as rs-convert -r of the RealSense SDK names depth
/// counts without a header.
bool is_depth_dump(const std::filesystem::path& path);

/// Time in a file name [s]: its last number, if it has at least ten digits before the decimal point
/// and does not start with 0 (seconds, milli-, micro- or nanoseconds since 1970).
std::optional<double> timestamp_in_name(const std::filesystem::path& path);

// ---- Times and gravity: text files beside the images, as in TUM's RGB-D recordings ----

/// The file NAME in the folder of the images, or beside a folder named `depth`; empty: none.
std::filesystem::path file_beside_images(const std::filesystem::path& folder, const char* name);

/// Image times from lists.
struct ListedTimes {
  struct Time {
    double s = 0;
    std::string list;  // file name
  };
  std::map<std::filesystem::path, Time> of_image;  // images as named by the caller
  std::vector<std::string> warnings;
};

/// Reads depth.txt and rgb.txt (`timestamp file` per line) and associations.txt (two such pairs per
/// line, in either order). Ignores files that name none of the images. Throws Error naming file and
/// line if another line of a list is damaged or names an image twice.
ListedTimes listed_times(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& depth,
                         const std::vector<std::filesystem::path>& color);

/// The times in poses.tum, whose line i belongs to frame i. Empty if there is no such file, if its
/// times are all 0, or, with a warning, if the number of poses differs. Throws Error naming file
/// and line.
std::vector<double> times_of_poses(const std::filesystem::path& folder,
                                   std::size_t frames,
                                   std::vector<std::string>& warnings);

/// accelerometer.txt: `timestamp ax ay az` [s, m/s2], as TUM publishes it for the Kinect.
class Accelerometer {
 public:
  /// No samples if the file does not exist. Throws Error naming file and line.
  explicit Accelerometer(const std::filesystem::path& folder);

  /// Whether there are samples near `time_s`.
  bool covers(double time_s) const { return !about(time_s).empty(); }
  /// In the camera frame, from the mean of the samples near `time_s`; nullopt if there are none, or
  /// their mean is not near 1 g.
  std::optional<Gravity> gravity_at(double time_s) const;

  static constexpr const char* kFile = "accelerometer.txt";
  /// Use samples within this time of the frame [s]. Shorter windows include the shaking of a hand,
  /// longer ones its rotation.
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
  std::optional<Intrinsics> color;  // only if a file distinguishes them from depth's
  std::optional<Pose> T_color_depth;
  std::vector<std::string> ignored;  // files named as calibrations, not understood
};

/// Reads the calibration in the folder: JSON with `intrinsic_matrix` (and `depth_scale`), OpenCV
/// XML, or a text file of numbers. Throws Error if a file named as intrinsics is damaged.
CameraFiles find_camera_files(const std::filesystem::path& folder);

// One per format; nullopt if the file has another format.
std::optional<CameraFacts> camera_from_json(const std::filesystem::path& path);
std::optional<CameraFiles> camera_from_opencv_xml(const std::filesystem::path& path);
std::optional<CameraFacts> camera_from_text(const std::filesystem::path& path);

// ---- Intrinsics for a recording whose files have none ----

/// Possible intrinsics of a recording.
struct CameraChoice {
  std::string name;  // the file that contains them, or the camera
  Intrinsics intrinsics;
  double depth_unit_m = 0.001;  // meters per count
  bool from_file = false;
};

/// Intrinsics for depth images of the recording's size: first those in files of neighboring
/// folders, then nominal values of common cameras. Skips damaged files.
std::vector<CameraChoice> camera_choices(const RecordingInfo& info);

/// The camera with these nominal values; empty: none.
std::string nominal_camera(const Intrinsics& intrinsics);

/// `<recording>.planescope.json` beside the recording.
std::filesystem::path camera_file(const RecordingInfo& info);
/// Stores the recording's intrinsics and depth unit in camera_file(), and keeps the other contents
/// of that file. Throws Error.
void remember_camera(const RecordingInfo& info);

}  // namespace planescope::io
