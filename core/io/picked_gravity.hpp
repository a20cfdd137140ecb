#pragma once

// Gravity that a user picked by clicking floors or walls. It lies in the folder of the recording's
// labels, never in the recording, and every command reads it again: docs/formats.md.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/recording.hpp"

namespace planescope::io {

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
