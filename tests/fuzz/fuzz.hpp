#pragma once

// Fuzz targets for readers of untrusted files and texts: each accepts arbitrary bytes. Built twice:
// with libFuzzer, which searches for harmful inputs (scripts/fuzz), and as a test that reads the
// stored corpus.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::fuzz {

using Bytes = std::span<const unsigned char>;
using ByteVector = std::vector<unsigned char>;

/// A folder of this process only, in memory if the system supports that.
const std::filesystem::path& memory_folder();
/// Writes the file `name` to it, creating folders.
std::filesystem::path file_of(const std::string& name, Bytes bytes);
std::string text_of(Bytes bytes);

struct Target {
  const char* name;  // also the name of its folder in tests/fuzz/corpus
  /// May throw Error. Any other exception is a finding, and so is a sanitizer's report.
  void (*read)(Bytes);
};

std::vector<Target> recording_targets();
std::vector<Target> label_targets();
std::vector<Target> document_targets();
std::vector<Target> world_targets();
std::vector<Target> desktop_targets();  // none in builds without the window
std::vector<Target> all_targets();

/// Throws std::logic_error, which is a finding, if `holds` is false.
void require(bool holds, const std::string& what);

/// Reads the bytes. Returns the message of the Error that rejected them, which has one line; empty
/// if they were accepted.
std::string read(const Target& target, Bytes bytes);

// ---- Data that targets read into ----

inline constexpr int kWidth = 8, kHeight = 6;

/// A wall, a floor and a hole.
Frame sample_frame();
/// 24 x 16 equal pixels.
Image16 plain_depth();
const labels::LabelGrid& label_grid();
/// Empty labels of a sample frame.
FrameLabels blank_labels(int frame);

}  // namespace planescope::fuzz
