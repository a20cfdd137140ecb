// List of all fuzz targets, and their shared inputs and checks.

#include "fuzz/fuzz.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "core/model/error.hpp"

namespace planescope::fuzz {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path;
  Folder() {
    const fs::path memory = "/dev/shm";
    path = (fs::is_directory(memory) ? memory : fs::temp_directory_path()) /
           ("planescope_fuzz." + std::to_string(getpid()));
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

const fs::path& memory_folder() {
  static const Folder folder;
  return folder.path;
}

fs::path file_of(const std::string& name, Bytes bytes) {
  const fs::path path = memory_folder() / name;
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  require(file.flush().good(), "the harness cannot write " + path.string());
  return path;
}

std::string text_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

#if !PLANESCOPE_FUZZ_DESKTOP
std::vector<Target> desktop_targets() { return {}; }
#endif

std::vector<Target> all_targets() {
  std::vector<Target> all = recording_targets();
  for (const auto& more : {label_targets(), document_targets(), world_targets(), desktop_targets()})
    std::ranges::copy(more, std::back_inserter(all));
  return all;
}

void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

std::string read(const Target& target, Bytes bytes) {
  try {
    target.read(bytes);
    return {};
  } catch (const Error& error) {
    const std::string message = error.what();
    require(!message.empty(), "an Error without a message");
    require(message.find('\n') == std::string::npos, "an Error of several lines: " + message);
    return message;
  }
}

// ---- Data that targets read into ----

Frame sample_frame() {
  Frame frame;
  frame.name = "sample";
  frame.depth = Image16(kWidth, kHeight);
  frame.depth_unit_m = 0.001;
  frame.intrinsics = {kWidth, kHeight, 8, 8, kWidth / 2.0, kHeight / 2.0};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      frame.depth.at(x, y) = static_cast<std::uint16_t>(y < 4 ? 1000 : 1000 - 100 * (y - 3));
  frame.depth.at(0, 0) = 0;
  return frame;
}

Image16 plain_depth() { return Image16(24, 16, 1, 1000); }

const labels::LabelGrid& label_grid() {
  static const labels::LabelGrid grid = labels::make_label_grid(sample_frame(), Gravity{});
  return grid;
}

FrameLabels blank_labels(int frame) {
  return labels::empty_labels(label_grid(), std::string(64, static_cast<char>('a' + frame)));
}

}  // namespace planescope::fuzz
