#pragma once

// Runs methods on labelled frames of real recordings, on depth sets and on neighbouring frames of a
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

/// True planes of labelled frames with fewer scored pixels are not scored.
inline constexpr int kLeastTruePixels = 200;

/// What a labelled frame is for: to tune a method on, or to print its figures.
enum class Half : std::uint8_t { tuning, printed };
constexpr std::array<const char*, 2> names_of(Half) { return {"tuning", "printed"}; }
inline const char* to_string(Half half) { return names_of(half)[static_cast<std::size_t>(half)]; }

/// Which frame of which recording.
struct LabelledName {
  std::string name;  // of the folder that its labels lie in
  Half half = Half::tuning;
  std::string recording;  // below the folder of recordings
  int frame = 0;
};
void visit_fields(auto& fields, Same<LabelledName> auto& name) {
  fields("name", name.name);
  fields("half", name.half);
  fields("recording", name.recording);
  fields("frame", name.frame);
}

/// How a method did on each of some frames.
struct MethodScores {
  CellKey method;  // of no frames
  std::vector<planes::Metrics> of_frames;
};

/// How frames of a recording are read and cropped.
struct Reading {
  io::RecordingOptions recording;
  planes::GravityOptions gravity;
  double max_range_m = planes::CloudOptions{}.max_range_m;
};

/// A frame of a list of labelled ones.
struct ListedFrame {
  LabelledName name;
  Reading reading;
};

/// A frame and its labels: LABELS/NAME holds label files as `planescope view --labels` writes them,
/// DATA/RECORDING the recording. Throws Error where either is missing or damaged.
EvaluationFrame read_listed(const ListedFrame& listed,
                            const std::filesystem::path& data,
                            const std::filesystem::path& labels);

// All are the same for any number of threads. `progress(done, all)` may be empty and may throw to
// stop.

/// Ours in its profiles, refined without each term of its objective, and every other method of this
/// build with its defaults.
std::vector<CellKey> real_methods();

/// real_methods(). `frames[i]` is what was read of `listed[i]`.
std::vector<MethodScores> measure_labelled(std::span<const ListedFrame> listed,
                                           std::span<const EvaluationFrame> frames,
                                           const CellTools& tools,
                                           const std::function<void(int, int)>& progress = {});

/// The same methods, but of our profiles refined alone, on the first `count` frames of a depth set,
/// 0: all that it has. True planes of fewer voxels than kMinTruthVoxels are not scored.
std::vector<MethodScores> measure_set(const CellKey& set,
                                      int count,
                                      const CellTools& tools,
                                      const std::function<void(int, int)>& progress = {});

// ---- From frame to frame: the same planes again, and the floor as one ----

/// Smaller planes, and smaller parts of the floor, do not count [px].
inline constexpr std::uint64_t kLeastRepeatPixels = 500;
/// Planes of neighbouring frames are partners from this IoU on.
inline constexpr double kPartnerIou = 0.5;

/// The planes found in a depth frame, by pixel.
struct PixelPlanes {
  std::vector<std::int32_t> plane_of;          // by pixel v * width + u: plane id, 0 none
  std::vector<PlaneFit> fits;                  // by id - 1, about the sensor, z up [m]
  std::vector<planes::Certainty> certainties;  // likewise
};
PixelPlanes pixel_planes(const planes::FrameResult& result);

/// What became of the planes of a frame in the next one. The camera's own movement is in all of it,
/// the same for every method.
struct Neighbours {
  int planes = 0;    // of at least kLeastRepeatPixels, in the first frame
  int partners = 0;  // of those, with a partner in the next
  // Of partners.
  std::vector<double> offset_jumps_m;
  std::vector<double> normal_jumps_deg;
  // Of two of them that stand 60 degrees and more to each other: how much the angle between them
  // changed, which no movement of the camera does, by what the certainty of all four tells.
  std::vector<double> angle_jumps_sigmas;
};
void visit_fields(auto& fields, Same<Neighbours> auto& n) {
  fields("planes", n.planes);
  fields("partners", n.partners);
  fields("offset_jumps_m", n.offset_jumps_m);
  fields("normal_jumps_deg", n.normal_jumps_deg);
  fields("angle_jumps_sigmas", n.angle_jumps_sigmas);
}
/// Both frames have as many pixels. A pixel is the same in both, wherever the camera went.
Neighbours compare_neighbours(const PixelPlanes& first, const PixelPlanes& next);

/// The floor of a depth frame, found from its pixels alone, whatever the method: the level below
/// the camera that most pixels lie within 3 cm of, then a plane fitted to the pixels near it, five
/// times. A pixel is near within 3 cm, and within 1 cm x z^2 where its depth z [m] makes that more,
/// as a stereo camera's noise grows. Of each pixel, whether it is the floor's: 1, else 0.
std::vector<std::uint8_t> floor_pixels(const planes::PreparedFrame& frame);

/// How whole the floor is in what was found.
struct FloorPieces {
  std::uint64_t pixels = 0;  // of the floor
  int pieces = 0;      // planes with at least kLeastRepeatPixels on it, at least half of their own
  double largest = 0;  // % of the floor's pixels that lie in any plane: in its largest piece
  double missing = 0;  // % of the floor's pixels: in no plane
};
void visit_fields(auto& fields, Same<FloorPieces> auto& floor) {
  fields("pixels", floor.pixels);
  fields("pieces", floor.pieces);
  fields("largest_percent", floor.largest);
  fields("missing_percent", floor.missing);
}
FloorPieces floor_pieces(std::span<const std::uint8_t> floor, const PixelPlanes& found);

/// Of a method on frames of a recording.
struct RepeatScores {
  CellKey method;
  std::vector<Neighbours> neighbours;  // frames i and i + step
  std::vector<FloorPieces> floor;      // by frame
};
/// On the first `count` frames of a recording, 0: all that it has. Each is compared with the one
/// `step` frames later.
std::vector<RepeatScores> measure_repeat(const io::Recording& recording,
                                         const Reading& reading,
                                         std::span<const CellKey> methods,
                                         int count,
                                         int step,
                                         const CellTools& tools,
                                         const std::function<void(int, int)>& progress = {});

}  // namespace planescope::lab
