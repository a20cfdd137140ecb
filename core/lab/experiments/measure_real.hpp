#pragma once

// Runs methods on labeled frames of real recordings, on depth sets and on neighboring frames of a
// recording, and scores them by pixel.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "core/io/recording.hpp"
#include "core/lab/experiments/measure_paper.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/foot/footholds.hpp"

namespace planescope::lab {

/// True planes of labeled frames with fewer scored pixels are not scored.
inline constexpr int kLeastTruePixels = 200;

/// Purpose of a labeled frame: tuning a method, or published results.
enum class Half : std::uint8_t { tuning, printed };
constexpr std::array<const char*, 2> names_of(Half) { return {"tuning", "printed"}; }
inline const char* to_string(Half half) { return names_of(half)[static_cast<std::size_t>(half)]; }

/// A frame of a recording.
struct LabeledName {
  std::string name;  // of the folder with its labels
  Half half = Half::tuning;
  std::string recording;  // below the folder of recordings
  int frame = 0;
};
void visit_fields(auto& fields, Same<LabeledName> auto& name) {
  fields("name", name.name);
  fields("half", name.half);
  fields("recording", name.recording);
  fields("frame", name.frame);
}

/// Scores of a method on each of several frames.
struct MethodScores {
  CellKey method;  // without frames
  std::vector<planes::Metrics> of_frames;
};

/// Settings for reading and cropping frames of a recording.
struct Reading {
  io::RecordingOptions recording;
  planes::GravityOptions gravity;
  double max_range_m = planes::CloudOptions{}.max_range_m;
};

/// A frame in a list of labeled frames.
struct ListedFrame {
  LabeledName name;
  Reading reading;
};

/// Reads a frame and its labels: LABELS/NAME contains label files of `planescope view --labels`,
/// DATA/RECORDING is the recording. Throws Error if either is missing or damaged.
EvaluationFrame read_listed(const ListedFrame& listed,
                            const std::filesystem::path& data,
                            const std::filesystem::path& labels);

// All are independent of the number of threads. `progress(done, all)` may be empty and may throw to
// stop.

/// Ours in its profiles, refined without each term of its objective, and every other method of this
/// build with its defaults.
std::vector<CellKey> real_methods();

/// Scores real_methods(). `frames[i]` was read from `listed[i]`.
std::vector<MethodScores> measure_labeled(std::span<const ListedFrame> listed,
                                          std::span<const EvaluationFrame> frames,
                                          const CellTools& tools,
                                          const std::function<void(int, int)>& progress = {});

/// The same methods, except that ours use only the profile refined, on the first `count` frames of
/// a depth set, 0: all frames. True planes with fewer voxels than kMinTruthVoxels are not scored.
std::vector<MethodScores> measure_set(const CellKey& set,
                                      int count,
                                      const CellTools& tools,
                                      const std::function<void(int, int)>& progress = {});

// ---- Between frames: repeated planes, and the floor as one plane ----

/// Smaller planes, and smaller parts of the floor, do not count [px].
inline constexpr std::uint64_t kLeastRepeatPixels = 500;
/// Minimum IoU of partner planes in neighboring frames.
inline constexpr double kPartnerIou = 0.5;

/// The planes found in a depth frame, by pixel.
struct PixelPlanes {
  std::vector<std::int32_t> plane_of;          // by pixel v * width + u: plane id, 0 none
  std::vector<PlaneFit> fits;                  // by id - 1, about the sensor, z up [m]
  std::vector<planes::Certainty> certainties;  // the same
};
PixelPlanes pixel_planes(const planes::FrameResult& result);

/// Changes of a frame's planes in the next frame. They include the camera's motion, which is the
/// same for every method.
struct Neighbors {
  int planes = 0;    // of at least kLeastRepeatPixels, in the first frame
  int partners = 0;  // of those, with a partner in the next
  // For partners.
  std::vector<double> offset_jumps_m;
  std::vector<double> normal_jumps_deg;
  // For pairs of partners at an angle of at least 60 degrees: change of that angle, which is
  // independent of the camera's motion, in standard deviations from the certainty of all four
  // planes.
  std::vector<double> angle_jumps_sigmas;
};
void visit_fields(auto& fields, Same<Neighbors> auto& n) {
  fields("planes", n.planes);
  fields("partners", n.partners);
  fields("offset_jumps_m", n.offset_jumps_m);
  fields("normal_jumps_deg", n.normal_jumps_deg);
  fields("angle_jumps_sigmas", n.angle_jumps_sigmas);
}
/// Compares pixels at equal positions, regardless of camera motion. The images have the same size.
Neighbors compare_neighbors(const PixelPlanes& first, const PixelPlanes& next);

/// The floor of a depth frame, found from its pixels alone, independent of the method: the level
/// below the camera with the most pixels within 3 cm, then a plane fitted to nearby pixels, five
/// times. Nearby means within 3 cm, or within 1 cm x z^2 at depth z [m] if that is more, like the
/// noise of a stereo camera. Per pixel: 1 for the floor, else 0.
std::vector<std::uint8_t> floor_pixels(const planes::PreparedFrame& frame);

/// Fragmentation of the floor in a result.
struct FloorPieces {
  std::uint64_t pixels = 0;  // of the floor
  int pieces = 0;            // planes with kLeastRepeatPixels and half of their pixels on it
  double largest = 0;        // % of the floor's pixels in planes that are in its largest piece
  double missing = 0;        // % of the floor's pixels: in no plane
};
void visit_fields(auto& fields, Same<FloorPieces> auto& floor) {
  fields("pixels", floor.pixels);
  fields("pieces", floor.pieces);
  fields("largest_percent", floor.largest);
  fields("missing_percent", floor.missing);
}
FloorPieces floor_pieces(std::span<const std::uint8_t> floor, const PixelPlanes& found);

/// A method's scores on frames of a recording.
struct RepeatScores {
  CellKey method;
  std::vector<Neighbors> neighbors;  // frames i and i + step
  std::vector<FloorPieces> floor;    // by frame
};
/// Runs on the first `count` frames of a recording, 0: all frames. Compares each with the frame
/// `step` later.
std::vector<RepeatScores> measure_repeat(const io::Recording& recording,
                                         const Reading& reading,
                                         std::span<const CellKey> methods,
                                         int count,
                                         int step,
                                         const CellTools& tools,
                                         const std::function<void(int, int)>& progress = {});

}  // namespace planescope::lab
