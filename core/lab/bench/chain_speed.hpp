#pragma once

// How fast everything from a recording's frame to the planes of its pixels is: each stage beside
// its floor, whole frames beside other methods, and what they allocate.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
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
void visit_fields(auto& fields, Same<Allocations> auto& allocations) {
  fields("calls", allocations.calls);
  fields("bytes", allocations.bytes);
}
using CountAllocations = std::function<Allocations(const std::function<void()>&)>;

/// What all parts share.
struct SpeedTools {
  std::shared_ptr<const planes::Classifier> gcn, pca;
  planes::NetworkConfig network;  // of gcn
  planes::PcaClassifierOptions pca_options;
  Peaks peaks;
  int rounds = 20;
  int threads = 1;              // the most that scaling is measured with
  int most_points = 1'000'000;  // likewise
  /// Those of Open3D, ready to run on a frame's points; empty where the program has none.
  std::function<std::function<void()>(const planes::Cloud&, double)> open3d_voxels;
  std::function<std::function<void()>(std::span<const Vec3f>, const planes::Cube&)> open3d_octree;
  CountAllocations count_allocations;  // empty: this build cannot count
  /// Called before each turn with what is measured; may throw to stop. Never empty.
  std::function<void(const std::string&)> before;
};

struct StageRow {
  std::string stage;
  Times ms = {};
  Work work = {};                               // of the frame in the middle, by floor
  Floor floor = {};                             // likewise
  double ratio = 0;                             // median of ms / floor, round by round
  std::optional<Allocations> allocations = {};  // of one frame; of the memory part alone
};
void visit_fields(auto& fields, Same<StageRow> auto& row) {
  fields("stage", row.stage);
  fields("ms", row.ms);
  fields("bytes", row.work.bytes);
  fields("flops", row.work.flops);
  fields("floor_ms", row.floor.ms);
  fields("bound_by", row.floor.by_bytes ? "bytes" : "flops");
  fields("ratio", row.ratio);
  fields("allocations", row.allocations);
}

/// Every stage on what the stages before it made, one thread, all in turn.
std::vector<StageRow> measure_stages(const SpeedSubject& subject, const SpeedTools& tools);

struct DuelRow {
  std::string stage, rival;
  Times ours_ms = {}, rival_ms = {};
  double ratio = 0;  // median of rival / ours, side by side
};
void visit_fields(auto& fields, Same<DuelRow> auto& row) {
  fields("stage", row.stage);
  fields("rival", row.rival);
  fields("ours_ms", row.ours_ms);
  fields("rival_ms", row.rival_ms);
  fields("ratio", row.ratio);
}

/// The voxel grid against Open3D's, the octree, every node of it made, against Open3D's of
/// pointers, and PCA normals against nanoflann's neighbours and Eigen's normals; one thread.
std::vector<DuelRow> measure_duels(const SpeedSubject& subject, const SpeedTools& tools);

struct MethodRow {
  std::string method;
  Times ms = {};
  double ratio = 0;  // median of this / region growing, side by side
  double planes = 0;
  std::optional<Allocations> allocations = {};
  double peak_mib = 0;  // more than the process had resident before the frame; 0: not known
};
void visit_fields(auto& fields, Same<MethodRow> auto& row) {
  fields("method", row.method);
  fields("ms", row.ms);
  fields("ratio", row.ratio);
  fields("planes", row.planes);
  fields("allocations", row.allocations);
  fields("peak_mib", row.peak_mib);
}

/// A frame in memory to the planes of its pixels, one thread: ours with either profile and either
/// classifier, and every rival that this program has and that takes such frames. Region growing on
/// 20 px cells, as CAPE does it, is first, and what others are told against.
std::vector<MethodRow> measure_methods(const SpeedSubject& subject, const SpeedTools& tools);

// On the subject's first frame, after it ran twice: what is kept from frame to frame is there.
// Stages and methods with their `allocations`, methods with `peak_mib`; no times.
std::vector<StageRow> measure_stage_memory(const SpeedSubject& subject, const SpeedTools& tools);
std::vector<MethodRow> measure_method_memory(const SpeedSubject& subject, const SpeedTools& tools);

// What these share: ours on one thread, and what work allocates the third time, nullopt where the
// tools cannot count.
planes::PipelineOptions ours_with(const SpeedSubject& subject, planes::Profile profile);
std::optional<Allocations> steady_allocations(const SpeedSubject& subject,
                                              const SpeedTools& tools,
                                              const std::function<void()>& work);

// ---- How long whole programs take, from their start to their end ----

struct TimedCommand {
  std::string name;               // in the tables
  std::vector<std::string> args;  // the program's path first
};

struct CommandRow {
  std::string name;
  Times wall_ms = {}, cpu_ms = {};
  double peak_mib = 0;  // resident, of one run
};
void visit_fields(auto& fields, Same<CommandRow> auto& row) {
  fields("command", row.name);
  fields("wall_ms", row.wall_ms);
  fields("cpu_ms", row.cpu_ms);
  fields("peak_mib", row.peak_mib);
}

/// Each command once in every round, in turn. What they print is dropped. Throws Error where one
/// cannot be started or fails. `before`: as in interleaved_ms().
std::vector<CommandRow> measure_commands(std::span<const TimedCommand> commands,
                                         int rounds,
                                         const std::function<void()>& before);

}  // namespace planescope::lab
