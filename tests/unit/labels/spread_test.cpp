#include "core/labels/review/carry.hpp"

#include <gtest/gtest.h>

#include "core/labels/edit/operations.hpp"
#include "core/model/error.hpp"
#include "small_frames.hpp"

namespace planescope::labels {
namespace {

using test::TrueFrame;

/// A camera that goes past boxes; frame 2 has no pose.
struct Walk {
  std::vector<TrueFrame> frames;
  std::vector<Pose> poses;

  Walk() {
    const lab::Scene scene = lab::make_scene("boxes", 1);
    lab::CameraPose camera = scene.camera;
    for (int i = 0; i < 5; ++i) {
      frames.push_back(test::view_of(scene, camera, false));
      poses.push_back(lab::pose_of(camera));
      camera.position += Vec3d(0.05, 0.06, 0);
      camera.yaw_deg -= 3;
    }
  }
  SpreadJob job(int from) const {
    SpreadJob job;
    job.from = from;
    job.frames = static_cast<int>(frames.size());
    job.open = [this, from](int i) -> SpreadFrame {
      const TrueFrame& frame = frames[static_cast<std::size_t>(i)];
      return {frame.frame, frame.grid, i == from ? frame.truth : empty_labels(frame.grid, "")};
    };
    job.T_world_camera = [this](int i) -> std::optional<Pose> {
      if (i == 2) return std::nullopt;
      return poses[static_cast<std::size_t>(i)];
    };
    return job;
  }
};

const Walk& walk() {
  static const Walk made;
  return made;
}

FrameLabels with(const Proposal& proposal) {
  FrameLabels labels =
      empty_labels(walk().frames[static_cast<std::size_t>(proposal.edit.frame)].grid, "");
  apply_edit(labels, proposal.edit);
  return labels;
}

TEST(Spread, LabelsOfOneFrameLandOnTheirPlanesInAllOthersWithAPose) {
  const std::vector<Proposal> proposals = spread_labels(walk().job(1));
  std::vector<int> frames;
  for (const Proposal& proposal : proposals) frames.push_back(proposal.edit.frame);
  EXPECT_EQ(frames, (std::vector{0, 3, 4}));
  for (const Proposal& proposal : proposals) {
    const FrameLabels labels = with(proposal);
    const TrueFrame& there = walk().frames[static_cast<std::size_t>(proposal.edit.frame)];
    int compared = 0;
    for (const LabelPlane& plane : there.truth.planes) {
      const PixelSet expected = pixels_of_plane(there.truth, plane.id);
      if (expected.size() < 5000 || !find_plane(walk().frames[1].truth, plane.id)) continue;
      ++compared;
      EXPECT_GT(test::iou(pixels_of_plane(labels, plane.id), expected), 0.85)
          << "frame " << proposal.edit.frame << ", P" << plane.id;
    }
    EXPECT_GE(compared, 2);
  }
}

TEST(Spread, LeavesWhatIsLabelledAlreadyAndStops) {
  SpreadJob job = walk().job(1);
  const auto open = job.open;
  job.open = [&](int i) {
    SpreadFrame frame = open(i);
    if (i == 3)
      frame.labels =
          painted(frame.labels, frame.grid, test::rectangle(frame.grid, 200, 200, 300, 300),
                  {1, Label::v}, PaintMode::over);
    return frame;
  };
  const std::vector<Proposal> proposals = spread_labels(job);
  const auto third = std::ranges::find_if(
      proposals, [](const Proposal& proposal) { return proposal.edit.frame == 3; });
  ASSERT_NE(third, proposals.end());
  for (const LabelRun& run : third->edit.runs) EXPECT_EQ(run.plane_before, 0);

  std::stop_source stop;
  job.stop = stop.get_token();
  job.progress = [&](int, int) { stop.request_stop(); };
  EXPECT_THROW(spread_labels(job), Cancelled);
}

TEST(Spread, NeedsPlanesAndAPose) {
  SpreadJob job = walk().job(2);
  EXPECT_THROW(spread_labels(job), Error);
  job = walk().job(1);
  const auto open = job.open;
  job.open = [&](int i) {
    SpreadFrame frame = open(i);
    frame.labels = empty_labels(frame.grid, "");
    return frame;
  };
  EXPECT_THROW(spread_labels(job), Error);
}

}  // namespace
}  // namespace planescope::labels
