#pragma once

// Speed of everything from a recording's frame to the planes of its pixels: each stage compared
// with its floor, whole frames compared with other methods, and their allocations.

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
  std::vector<Frame> frames;               // at least one; each round uses the next
  std::function<Frame(std::size_t)> load;  // reads frames[i] again; empty if generated
  planes::PipelineOptions options;         // its gravity, range and voxels
};

/// Allocations of some work on the calling thread.
struct Allocations {
  std::uint64_t calls = 0, bytes = 0;
};
void visit_fields(auto& fields, Same<Allocations> auto& allocations) {
  fields("calls", allocations.calls);
  fields("bytes", allocations.bytes);
}
using CountAllocations = std::function<Allocations(const std::function<void()>&)>;

/// Settings shared by all parts.
struct SpeedTools {
  std::shared_ptr<const planes::Classifier> gcn, pca;
  planes::NetworkConfig network;  // of gcn
  planes::PcaClassifierOptions pca_options;
  Peaks peaks;
  int rounds = 20;
  int threads = 1;              // maximum for measuring scaling
  int most_points = 1'000'000;  // the same
  /// Prepare Open3D's versions for a frame's points; empty if the program lacks Open3D.
  std::function<std::function<void()>(const planes::Cloud&, double)> open3d_voxels;
  std::function<std::function<void()>(std::span<const Vec3f>, const planes::Cube&)> open3d_octree;
  CountAllocations count_allocations;  // empty: not available in this build
  /// Called before each turn with a description of the measurement; may throw to stop. Never empty.
  std::function<void(const std::string&)> before;
};

struct StageRow {
  std::string stage;
  Times ms = {};
  Work work = {};                               // of the middle frame, by its floor
  Floor floor = {};                             // the same
  double ratio = 0;                             // median of ms / floor, round by round
  std::optional<Allocations> allocations = {};  // of one frame; only in the memory part
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

/// Runs every stage on the output of the previous stages, interleaved, on one thread.
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

/// Compares on one thread: the voxel grid with Open3D's, the octree with all nodes with Open3D's
/// pointer octree, and PCA normals with nanoflann's neighbors and Eigen's normals.
std::vector<DuelRow> measure_duels(const SpeedSubject& subject, const SpeedTools& tools);

struct MethodRow {
  std::string method;
  Times ms = {};
  double ratio = 0;  // median of this / region growing, side by side
  double planes = 0;
  std::optional<Allocations> allocations = {};
  double peak_mib = 0;  // above the process's resident memory before the frame; 0: unknown
};
void visit_fields(auto& fields, Same<MethodRow> auto& row) {
  fields("method", row.method);
  fields("ms", row.ms);
  fields("ratio", row.ratio);
  fields("planes", row.planes);
  fields("allocations", row.allocations);
  fields("peak_mib", row.peak_mib);
}

/// Times a frame from memory to the planes of its pixels, on one thread: ours with either profile
/// and either classifier, and every available rival for such frames. Region growing on 20 px cells,
/// as in CAPE, comes first and is the reference for the others.
std::vector<MethodRow> measure_methods(const SpeedSubject& subject, const SpeedTools& tools);

// On the subject's first frame after two warm-up runs, so that buffers kept between frames exist.
// Stages and methods with `allocations`, methods with `peak_mib`; no times.
std::vector<StageRow> measure_stage_memory(const SpeedSubject& subject, const SpeedTools& tools);
std::vector<MethodRow> measure_method_memory(const SpeedSubject& subject, const SpeedTools& tools);

// Shared by both: our options on one thread, and the allocations of the third run of `work`,
// nullopt if the tools cannot count.
planes::PipelineOptions ours_with(const SpeedSubject& subject, planes::Profile profile);
std::optional<Allocations> steady_allocations(const SpeedSubject& subject,
                                              const SpeedTools& tools,
                                              const std::function<void()>& work);

// ---- Duration of whole programs, from start to end ----

struct TimedCommand {
  std::string name;               // in the tables
  std::vector<std::string> args;  // starts with the program's path
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

/// Runs each command once per round, interleaved. Discards their output. Throws Error if one cannot
/// be started or fails. `before`: as in interleaved_ms().
std::vector<CommandRow> measure_commands(std::span<const TimedCommand> commands,
                                         int rounds,
                                         const std::function<void()>& before);

}  // namespace planescope::lab
