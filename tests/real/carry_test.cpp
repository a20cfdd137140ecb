// Labels carried over frames of real recordings ($PLANESCOPE_DATA), compared with a new wand click
// in the last frame.

#include "core/labels/review/carry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/io/recording.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand.hpp"
#include "support/label_drafts.hpp"

namespace planescope::labels {
namespace {

constexpr int kFrames = 5;
constexpr double kSame_m = 0.02;         // distance within which two frames see the same surface
constexpr std::size_t kSpeck_px = 25;    // smaller parts are specks
constexpr std::size_t kLeast_px = 3000;  // smaller surfaces are ignored

/// A surface that is clicked in one frame, carried over kFrames, and clicked again at the same
/// pixel.
struct Surface {
  const char* recording;
  int frame = 0, u = 0, v = 0;
};

/// Compared with a new click in the last frame. Ignores areas that the first frame saw but the
/// first click did not select, because that was the labeler's choice.
struct Accuracy {
  double coverage = 0;      // share of the wand's pixels that the carried plane covers
  double new_coverage = 0;  // the same for pixels that the first frame did not see
  double leakage = 0;       // share of the carried plane's pixels that neither click selected
  std::size_t specks = 0;
};

PixelSet wand_at(const LabelGrid& grid, int u, int v) {
  const auto seed = static_cast<std::uint32_t>(v * grid.width + u);
  const auto found = grow_plane(grid, nullptr, std::span(&seed, 1), {});
  return found ? found->pixels : PixelSet{};
}

std::optional<Accuracy> accuracy_of(const Surface& surface) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data) return std::nullopt;
  const std::filesystem::path path = std::filesystem::path(data) / surface.recording;
  if (!std::filesystem::exists(path)) return std::nullopt;
  const std::shared_ptr<const io::Recording> recording = io::open_recording(path, {});

  Frame frame = recording->frame(surface.frame);
  LabelGrid grid = make_label_grid(frame, {});
  const LabelGrid first = grid;
  const PixelSet click = wand_at(grid, surface.u, surface.v);
  if (click.size() < kLeast_px) return std::nullopt;
  const FrameLabels clicked = painted(empty_labels(grid, ""), grid, click, {1}, PaintMode::over);
  FrameLabels labels = clicked;
  Pose T_to_first = Pose::Identity();
  for (int k = 1; k <= kFrames; ++k) {
    Frame next = recording->frame(surface.frame + k);
    LabelGrid next_grid = make_label_grid(next, {});
    CarriedLabels carried =
        carry_labels(frame, grid, labels, next, next_grid, empty_labels(next_grid, ""), {}, {});
    labels = std::move(carried.labels);
    T_to_first = carried.T_to_from * T_to_first;
    frame = std::move(next);
    grid = std::move(next_grid);
  }

  std::vector<std::uint8_t> again(grid.pixels(), 0);
  const PixelSet last = wand_at(grid, surface.u, surface.v);
  const auto pixel = static_cast<std::size_t>(surface.v) * grid.width + surface.u;
  if (last.size() < kLeast_px || labels.plane.data[pixel] != 1) return std::nullopt;
  for (const std::uint32_t i : last) again[i] = 1;
  const Pose T_first_to = T_to_first.inverse();
  std::size_t all = 0, both = 0, new_all = 0, new_both = 0, carried = 0, leaked = 0;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const Vec3d point = T_first_to * grid.points[i].cast<double>();
    const auto at = first.pixel_that_sees(point);
    const bool seen = at && first.measured[*at] &&
                      std::abs(point.norm() - double{first.points[*at].norm()}) < kSame_m;
    const bool was_clicked = seen && clicked.plane.data[*at] == 1;
    const bool is_carried = labels.plane.data[i] == 1;
    if (again[i] && (!seen || was_clicked)) {
      ++all;
      both += is_carried;
      new_all += !seen;
      new_both += !seen && is_carried;
    }
    carried += is_carried;
    leaked += is_carried && !again[i] && !was_clicked;
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  Accuracy accuracy{share(both, all), share(new_both, new_all), share(leaked, carried)};
  for (const PixelSet& part : connected_parts(grid, pixels_of_plane(labels, 1), 2))
    accuracy.specks += part.size() < kSpeck_px;
  std::printf("frame %d: coverage %.1f %%, of new ground %.1f %%, leakage %.1f %%, %zu specks\n",
              surface.frame, 100 * accuracy.coverage, 100 * accuracy.new_coverage,
              100 * accuracy.leakage, accuracy.specks);
  return accuracy;
}

// Uses all starting frames for which the pixel is still on the surface in the last frame.
TEST(RealCarry, ASurfaceIsLabeledToItsEdgesAfterFiveFrames) {
  std::vector<Accuracy> all;
  for (int frame = 0; frame + kFrames < 300; frame += 30)
    if (const auto found = accuracy_of({"tum_fr1_rpy_kinect_640x480", frame, 200, 300}))
      all.push_back(*found);
  if (all.empty()) GTEST_SKIP() << "PLANESCOPE_DATA is not set, or lacks the recording";
  Accuracy mean;
  for (const Accuracy& one : all) {
    mean.coverage += one.coverage / static_cast<double>(all.size());
    mean.new_coverage += one.new_coverage / static_cast<double>(all.size());
    mean.leakage += one.leakage / static_cast<double>(all.size());
    mean.specks += one.specks;
  }
  std::printf("mean of %zu: coverage %.1f %%, of new ground %.1f %%, leakage %.1f %%, %zu specks\n",
              all.size(), 100 * mean.coverage, 100 * mean.new_coverage, 100 * mean.leakage,
              mean.specks);
  EXPECT_GE(mean.coverage, 0.96);
  EXPECT_GE(mean.new_coverage, 0.78);
  EXPECT_LE(mean.leakage, 0.03);
  EXPECT_LE(mean.specks, 0U);
}

}  // namespace
}  // namespace planescope::labels
