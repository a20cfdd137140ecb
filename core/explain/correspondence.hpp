#pragma once

// What of one run is what of another: nodes by their cells, voxels by their pixels. Internal to
// core/explain.

#include <cstdint>
#include <vector>

#include "core/replay/run.hpp"

namespace planescope {

class Correspondence {
 public:
  Correspondence(const Run& from, const Run& to);

  bool same_voxels() const { return same_voxels_; }
  /// -1 where the cell is not a node of the other run, or the octrees' cubes differ.
  std::int32_t node(std::int32_t node) const;
  /// Of the voxel's first pixel; -1 where the other run cropped that.
  std::int32_t voxel(std::int32_t voxel) const;
  /// The same decision, whatever the planes' numbers and the measured values.
  bool same_event(const TraceEvent& from, const TraceEvent& to) const;

 private:
  const Run& from_;
  const Run& to_;
  bool same_voxels_ = false;
  std::vector<std::int32_t> voxels_;  // empty where they are the same
};

}  // namespace planescope
