#pragma once

// What reads files and texts that anybody may have written, as targets: each reads any bytes. Built
// twice: with libFuzzer, which looks for bytes that do harm (scripts/fuzz), and as a test that
// reads the kept corpus.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::fuzz {

using Bytes = std::span<const unsigned char>;
using ByteVector = std::vector<unsigned char>;

/// Files of this process alone, in memory where the system has such a folder.
const std::filesystem::path& memory_folder();
/// Writes `name` there; its folder is made.
std::filesystem::path file_of(const std::string& name, Bytes bytes);
std::string text_of(Bytes bytes);

struct Target {
  const char* name;  // also of its folder in tests/fuzz/corpus
  /// May throw Error. Anything else that is thrown is a finding, as what a sanitizer reports is.
  void (*read)(Bytes);
};

std::vector<Target> recording_targets();
std::vector<Target> label_targets();
std::vector<Target> document_targets();
std::vector<Target> world_targets();
std::vector<Target> desktop_targets();  // none in builds without the window
std::vector<Target> all_targets();

/// Throws std::logic_error, a finding, where `holds` is false.
void require(bool holds, const std::string& what);

/// Reads the bytes. Returns the Error by which they were refused, of one line; empty: they were
/// read.
std::string read(const Target& target, Bytes bytes);

// ---- What targets read into ----

inline constexpr int kWidth = 8, kHeight = 6;

/// A wall, a floor and a hole.
Frame sample_frame();
/// 24 x 16 pixels, all of them alike.
Image16 plain_depth();
const labels::LabelGrid& label_grid();
/// Of that frame: nothing drawn yet.
FrameLabels blank_labels(int frame);

}  // namespace planescope::fuzz
