// overview.png: a recording's frames as an animation.

#include <algorithm>
#include <cstdint>

#include "core/io/image/apng.hpp"
#include "core/io/image/jpeg.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/page/thumbnail.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 480;
constexpr std::size_t kMostFrames = 200;
constexpr int kFramesPerSecond = 5;
constexpr int kShades = 32;  // per channel: noise of the camera costs most of the bytes

const ReportPicture* overlay_of(const ReportFrame& frame) {
  const auto found = std::ranges::find(frame.pictures, "overlay", &ReportPicture::name);
  return found == frame.pictures.end() ? nullptr : &*found;
}

/// The copies that are there, of long recordings evenly chosen ones.
std::vector<fs::path> chosen_copies(const fs::path& dir, const ReportRecording& recording) {
  std::vector<fs::path> copies;
  for (const ReportFrame& frame : recording.frames)
    if (const ReportPicture* picture = overlay_of(frame))
      if (fs::path copy = dir / copy_of(*picture); fs::is_regular_file(copy))
        copies.push_back(std::move(copy));
  if (copies.size() <= kMostFrames) return copies;
  std::vector<fs::path> chosen;
  for (std::size_t k = 0; k < kMostFrames; ++k)
    chosen.push_back(copies[k * (copies.size() - 1) / (kMostFrames - 1)]);
  return chosen;
}

/// Of `width` x `height`: cut off or filled up where the frame is of another shape.
Image8 fitted(const Image8& image, int width, int height) {
  Image8 result(width, height, 3);
  const int columns = 3 * std::min(width, image.width);
  for (int y = 0; y < std::min(height, image.height); ++y)
    std::copy_n(&image.at(0, y), columns, &result.at(0, y));
  return result;
}

Image8 small_copy(const fs::path& copy) {
  Image8 image = shrink(io::read_jpeg_rgb(copy), kWidth);
  for (std::uint8_t& value : image.data)
    value = static_cast<std::uint8_t>((value * (kShades - 1) + 127) / 255 * 255 / (kShades - 1));
  return image;
}

void write_overview(const fs::path& file, const std::vector<fs::path>& copies) {
  Image8 image;
  for (std::size_t k = 0; k < copies.size() && image.empty(); ++k) try {
      image = small_copy(copies[k]);
    } catch (const Error&) {
      // Damaged: the next one's size counts.
    }
  if (image.empty()) return;
  const int width = image.width, height = image.height;
  write_file_stream(file, [&](std::ostream& out) {
    io::ApngWriter writer(out, width, height, static_cast<int>(copies.size()), kFramesPerSecond);
    for (const fs::path& copy : copies) {
      try {
        image = fitted(small_copy(copy), width, height);
      } catch (const Error&) {
        // Damaged: the frame before stays.
      }
      writer.add(image);
    }
    writer.finish();
  });
}

}  // namespace

std::string overview_of(const ReportRecording& recording) {
  for (const ReportFrame& frame : recording.frames)
    if (const ReportPicture* picture = overlay_of(frame)) {
      // Beside the folder "frames" of "frames/000012/pictures/overlay.png".
      const fs::path frames = fs::path(picture->file).parent_path().parent_path().parent_path();
      return (frames.parent_path() / "overview.png").generic_string();
    }
  return "";
}

void write_overviews(const fs::path& dir, const Report& report) {
  for (const ReportRecording& recording : report.recordings) {
    const std::vector<fs::path> copies = chosen_copies(dir, recording);
    if (copies.size() > 1) write_overview(dir / overview_of(recording), copies);
  }
}

}  // namespace planescope::report
