// Pictures for report pages: reduced copies, plane maps and overview animations.

#include "core/report/page/pictures.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/data/report_files.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;

/// Source pixels covered by a target pixel, from `first` on, and the share of each.
struct Span {
  int first = 0;
  std::vector<double> shares;  // sum: 1
};
std::vector<Span> spans(int source, int target) {
  std::vector<Span> result;
  const double scale = static_cast<double>(source) / target;
  for (int i = 0; i < target; ++i) {
    const double begin = i * scale, end = (i + 1) * scale;
    Span span;
    span.first = static_cast<int>(std::floor(begin));
    const int last = std::min(source, static_cast<int>(std::ceil(end - 1e-9)));
    for (int pixel = span.first; pixel < last; ++pixel)
      span.shares.push_back((std::min(end, pixel + 1.0) - std::max(begin, double(pixel))) / scale);
    result.push_back(span);
  }
  return result;
}

/// The mean of the source rows of a target row, at the source's width.
void mean_of_rows(const Image8& image, const Span& rows, std::vector<float>& mean) {
  std::ranges::fill(mean, 0.0f);
  int y = rows.first;
  for (const double part : rows.shares) {
    const std::uint8_t* row = &image.at(0, y++);
    const auto share = static_cast<float>(part);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += share * static_cast<float>(row[i]);
  }
}

constexpr int kCell = 4;         // pixels per sample, leaving room for hatches and outlines
constexpr int kMostWidth = 480;  // with many samples, fewer pixels each
constexpr int kHatch = 8;        // pixels between strokes

using Rgba8 = std::array<std::uint8_t, 4>;
constexpr Rgba8 kNothing = {0, 0, 0, 0}, kNoPlane = {128, 134, 142, 90};
constexpr Rgba8 kOutline = {28, 30, 34, 255}, kBorder = {255, 255, 255, 210};
constexpr const char* kLost = "#5d646d";

Rgba8 rgba_of(const std::string& color) {
  Rgba8 rgba = {136, 136, 136, 255};
  if (color.size() == 7)
    for (std::size_t c = 0; c < 3; ++c)
      std::from_chars(color.data() + 1 + 2 * c, color.data() + 3 + 2 * c, rgba[c], 16);
  return rgba;
}

Rgba8 lighter(Rgba8 color) {
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<std::uint8_t>(color[c] + (255 - color[c]) * 2 / 3);
  return color;
}

class Map {
 public:
  Map(const RegionSample& sample, const std::vector<PlaneInk>& inks)
      : inks_(inks), plane_of_(sample.plane_of()), columns_(sample.columns), rows_(sample.rows) {
    cell_ = std::max(1, std::min(kCell, kMostWidth / sample.columns));
    for (const PlaneInk& ink : inks) colors_.push_back(rgba_of(ink.color));
  }

  Image8 draw() const {
    Image8 image(columns_ * cell_, rows_ * cell_, 4);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Rgba8 color = color_at(x, y);
        std::copy(color.begin(), color.end(), &image.at(x, y));
      }
    return image;
  }

 private:
  int plane_at(int x, int y) const {  // of a pixel; outside -1
    if (x < 0 || y < 0 || x >= columns_ * cell_ || y >= rows_ * cell_) return -1;
    return plane_of_[static_cast<std::size_t>(y / cell_) * columns_ + x / cell_];
  }
  bool is_edge(int x, int y, int plane, int width) const {
    return plane_at(x - width, y) != plane || plane_at(x + width, y) != plane ||
           plane_at(x, y - width) != plane || plane_at(x, y + width) != plane;
  }
  Rgba8 color_at(int x, int y) const {
    const int plane = plane_at(x, y);
    if (plane < 0) return kNothing;
    if (plane == 0 || plane > static_cast<int>(inks_.size())) return kNoPlane;
    const Rgba8 color = colors_[static_cast<std::size_t>(plane) - 1];
    if (!inks_[static_cast<std::size_t>(plane) - 1].marked)
      return is_edge(x, y, plane, 1) ? kBorder : color;
    if (is_edge(x, y, plane, 2)) return kOutline;
    return (x + y) % kHatch < kHatch / 2 ? color : lighter(color);
  }

  const std::vector<PlaneInk>& inks_;
  std::vector<int> plane_of_;
  int columns_, rows_, cell_ = 1;
  std::vector<Rgba8> colors_;
};

// overview.png: a recording's frames as an animation.

constexpr int kOverviewWidth = 480;
constexpr std::size_t kMostFrames = 200;
constexpr int kFramesPerSecond = 5;
constexpr int kShades = 32;  // per channel: most of the file would be camera noise

const ReportPicture* overlay_of(const ReportFrame& frame) {
  const auto found = std::ranges::find(frame.pictures, "overlay", &ReportPicture::name);
  return found == frame.pictures.end() ? nullptr : &*found;
}

/// The existing copies; for long recordings, evenly spaced ones.
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

/// Crops or pads the image to `width` x `height` if the frame has another shape.
Image8 fitted(const Image8& image, int width, int height) {
  Image8 result(width, height, 3);
  const int columns = 3 * std::min(width, image.width);
  for (int y = 0; y < std::min(height, image.height); ++y)
    std::copy_n(&image.at(0, y), columns, &result.at(0, y));
  return result;
}

Image8 small_copy(const fs::path& copy) {
  Image8 image = shrink(io::read_webp_rgb(copy), kOverviewWidth);
  for (std::uint8_t& value : image.data)
    value = static_cast<std::uint8_t>((value * (kShades - 1) + 127) / 255 * 255 / (kShades - 1));
  return image;
}

void write_overview(const fs::path& file, const std::vector<fs::path>& copies) {
  Image8 image;
  for (std::size_t k = 0; k < copies.size() && image.empty(); ++k) try {
      image = small_copy(copies[k]);
    } catch (const Error&) {
      // Damaged: use the size of the next one.
    }
  if (image.empty()) return;
  const int width = image.width, height = image.height;
  write_file_stream(file, [&](std::ostream& out) {
    io::ApngWriter writer(out, width, height, static_cast<int>(copies.size()), kFramesPerSecond);
    for (const fs::path& copy : copies) {
      try {
        image = fitted(small_copy(copy), width, height);
      } catch (const Error&) {
        // Damaged: repeat the previous frame.
      }
      writer.add(image);
    }
    writer.finish();
  });
}

}  // namespace

Image8 shrink(const Image8& image, int max_width) {
  if (image.width <= max_width) return image;
  const int height =
      std::max(1, static_cast<int>(std::lround(double(image.height) * max_width / image.width)));
  Image8 small(max_width, height, image.channels);
  const std::vector<Span> columns = spans(image.width, max_width);
  const std::vector<Span> rows = spans(image.height, height);
  std::vector<float> mean(static_cast<std::size_t>(image.width) * image.channels);
  for (int y = 0; y < height; ++y) {
    mean_of_rows(image, rows[y], mean);
    std::uint8_t* out = &small.at(0, y);
    for (const Span& column : columns)
      for (int c = 0; c < image.channels; ++c) {
        const float* value = mean.data() + column.first * image.channels + c;
        float sum = 0.5f;
        for (const double share : column.shares) {
          sum += static_cast<float>(share) * *value;
          value += image.channels;
        }
        *out++ = static_cast<std::uint8_t>(std::min(sum, 255.0f));
      }
  }
  return small;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= left ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

Image8 draw_plane_map(const RegionSample& sample, const std::vector<PlaneInk>& inks) {
  if (sample.rows < 2 || sample.columns < 1) return {};
  return Map(sample, inks).draw();
}

ComparedInks compared_inks(const std::vector<PlaneComparison>& planes,
                           std::size_t planes_before,
                           const std::vector<std::string>& colors_now) {
  ComparedInks inks;
  inks.baseline.assign(planes_before, {kLost, true});
  for (const std::string& color : colors_now) inks.now.push_back({color, false});
  for (const PlaneComparison& plane : planes) {
    if (plane.fate == PlaneFate::gained)
      inks.now.at(static_cast<std::size_t>(plane.now) - 1).marked = true;
    if (plane.baseline > 0 && plane.now > 0)
      inks.baseline.at(static_cast<std::size_t>(plane.baseline) - 1) =
          inks.now.at(static_cast<std::size_t>(plane.now) - 1);
  }
  return inks;
}

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
