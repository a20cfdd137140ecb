#pragma once

// Runs methods on labelled frames, depth sets and neighbouring frames, and scores them by pixel.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "core/io/recording.hpp"
#include "core/lab/experiments/measure_paper.hpp"
#include "core/lab/experiments/real_results.hpp"
#include "core/planes/cloud/gravity.hpp"

namespace planescope::lab {

/// True planes of labelled frames with fewer scored pixels are not scored.
inline constexpr int kLeastTruePixels = 200;

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

/// Ours in its profiles and with either labeller, and every other method of this build with its
/// defaults. `frames[i]` is what was read of `listed[i]`.
LabelledScores measure_labelled(std::span<const ListedFrame> listed,
                                std::span<const EvaluationFrame> frames,
                                const CellTools& tools,
                                const std::function<void(int, int)>& progress = {});

/// The same methods, but of our profiles refined alone, on the first `count` frames of a depth set,
/// 0: all that it has. True planes of fewer voxels than kMinTruthVoxels are not scored.
SetScores measure_set(const CellKey& set,
                      int count,
                      const CellTools& tools,
                      const std::function<void(int, int)>& progress = {});

/// The methods of measure_labelled() on the first `count` frames of a recording, 0: all that it
/// has.
RepeatScores measure_repeat(const io::Recording& recording,
                            const Reading& reading,
                            int count,
                            const CellTools& tools,
                            const std::function<void(int, int)>& progress = {});

}  // namespace planescope::lab
