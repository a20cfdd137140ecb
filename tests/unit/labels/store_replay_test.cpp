#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "core/labels/store/journal_records.hpp"
#include "store_fixture.hpp"

namespace planescope::labels {
namespace {

/// What a brush of this place and size changes; `labels` follow.
LabelEdit stroke(FrameLabels& labels, int x, int y, int radius, int plane) {
  LabelEdit edit;
  edit.title = "Brush";
  const auto add = [&](std::uint32_t pixel) {
    LabelRun run = {pixel, 1, labels.plane.data[pixel], static_cast<std::uint16_t>(plane), 0, 0};
    if (run.plane_before == run.plane_after) return;
    if (!edit.runs.empty() && edit.runs.back().first + edit.runs.back().count == pixel &&
        edit.runs.back().plane_before == run.plane_before) {
      ++edit.runs.back().count;
    } else {
      edit.runs.push_back(run);
    }
  };
  for (int v = std::max(y - radius, 0); v <= std::min(y + radius, labels.plane.height - 1); ++v) {
    for (int u = std::max(x - radius, 0); u <= std::min(x + radius, labels.plane.width - 1); ++u) {
      const bool is_inside = (u - x) * (u - x) + (v - y) * (v - y) <= radius * radius;
      if (is_inside) add(static_cast<std::uint32_t>(v * labels.plane.width + u));
    }
  }
  apply_edit(labels, edit);
  return edit;
}

TEST(LabelStores, TenThousandGesturesAreReplayedExactly) {
  const auto dir = fresh_dir("replay");
  const FrameLabels nothing = blank_labels(640, 480);
  FrameLabels labels = nothing;
  Random random(1);
  std::vector<JournalBytes> records = {base_record({RecordKind::base, 0, 0, "ann"}, nothing)};
  for (int i = 0; i < 10000; ++i) {
    const LabelEdit edit = stroke(labels, random.integer(0, 639), random.integer(0, 479),
                                  random.integer(2, 50), random.integer(1, 30));
    records.push_back(edit_record({RecordKind::edit, 0, i, "ann"}, edit));
  }
  std::filesystem::create_directories(dir);
  Journal(dir / "journal", Journal::Access::write, nullptr).append(records);

  const auto start = std::chrono::steady_clock::now();
  LabelStore store(dir, by("ann"));
  const auto replayed = store.open(0, nothing);
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;
  std::printf("10000 gestures, journal of %.1f MB: replayed in %.0f ms\n",
              static_cast<double>(std::filesystem::file_size(dir / "journal")) / 1e6,
              elapsed.count());
  EXPECT_EQ(store.undo_count(), 10000u);
  EXPECT_EQ(replayed->plane.data, labels.plane.data);
}

}  // namespace
}  // namespace planescope::labels
