#pragma once

// How fast everything from a recording's frame to the planes of its pixels is: each stage beside
// its floor, whole frames beside other methods, and what they allocate.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/lab/bench/floors.hpp"
#include "core/lab/bench/measuring.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// Frames of one recording or set, held in memory.
struct SpeedSubject {
  std::string name;
  std::vector<Frame> frames;               // at least one; a round takes the next
  std::function<Frame(std::size_t)> load;  // reads frames[i] anew; empty where they were made
  planes::PipelineOptions options;         // its gravity, range and voxels
};

/// Work whose allocations are counted, on the calling thread.
struct Allocations {
  std::uint64_t calls = 0, bytes = 0;
};
using CountAllocations = std::function<Allocations(const std::function<void()>&)>;

/// What all parts share.
struct SpeedTools {
  std::shared_ptr<const planes::Classifier> gcn, pca;
  planes::NetworkConfig network;  // of gcn
  planes::PcaClassifierOptions pca_options;
  Peaks peaks;
  int rounds = 20;
  int threads = 1;                     // the most that scaling is measured with
  int most_points = 1'000'000;         // likewise
  CountAllocations count_allocations;  // empty: this build cannot count
  /// Called before each turn with what is measured; may throw to stop. Never empty.
  std::function<void(const std::string&)> before;
};

struct StageRow {
  std::string recording, stage;
  Times ms = {};
  Work work = {};                               // of the frame in the middle, by floor
  Floor floor = {};                             // likewise
  double ratio = 0;                             // median of ms / floor, round by round
  std::optional<Allocations> allocations = {};  // of one frame; of the memory part alone
};

/// Every stage on what the stages before it made, one thread, all in turn.
std::vector<StageRow> measure_stages(const SpeedSubject& subject, const SpeedTools& tools);

struct MethodRow {
  std::string recording, method;
  Times ms = {};
  double ratio = 0;  // median of this / region growing, side by side
  double planes = 0;
  std::optional<Allocations> allocations = {};
  double peak_mib = 0;  // of the whole process while the frame ran; 0: not known
};

/// A frame in memory to the planes of its pixels, one thread: ours with either profile and either
/// classifier, and every rival that this program has and that takes such frames. Region growing on
/// 20 px cells, as CAPE does it, is first, and what others are told against.
std::vector<MethodRow> measure_methods(const SpeedSubject& subject, const SpeedTools& tools);

/// The same stages and methods, once each on a frame that ran twice before: their `allocations`,
/// and the methods' `peak_mib`. No times.
struct Memory {
  std::vector<StageRow> stages;
  std::vector<MethodRow> methods;
};
Memory measure_memory(const SpeedSubject& subject, const SpeedTools& tools);

}  // namespace planescope::lab
