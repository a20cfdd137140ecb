// Labels carried to the next frame, and proposed for all frames with a known pose.

#include "core/labels/review/carry.hpp"

#include <gtest/gtest.h>

#include "core/labels/edit/operations.hpp"
#include "core/model/error.hpp"
#include "small_frames.hpp"
#include "support/label_drafts.hpp"

namespace planescope::labels {
namespace {

using test::TrueFrame;

/// Two views of a scene, which differ by 3 cm and about 1.5 degrees.
struct Step {
  TrueFrame from, to;
  Pose T_to_from;
};
Step step_in(const std::string& name, bool color) {
  const lab::Scene scene = lab::make_scene(name, 1);
  lab::CameraPose moved = scene.camera;
  moved.position += Vec3d(0.025, 0.015, 0.005);
  moved.yaw_deg += 1;
  moved.pitch_deg -= 1;
  moved.roll_deg += 0.5;
  return {test::view_of(scene, scene.camera, color), test::view_of(scene, moved, color),
          lab::pose_of(moved).inverse() * lab::pose_of(scene.camera)};
}

CarriedLabels carry(const Step& step, const FrameLabels& labels, const FrameLabels& existing) {
  return carry_labels(step.from.frame, step.from.grid, labels, step.to.frame, step.to.grid,
                      existing, {}, {});
}

TEST(Carry, LabelsLandOnTheirPlanesInTheNextFrame) {
  for (const bool color : {true, false}) {
    const Step step = step_in("boxes", color);
    const CarriedLabels carried = carry(step, step.from.truth, empty_labels(step.to.grid, ""));
    EXPECT_EQ(carried.method, color ? "RGB-D odometry" : "ICP");
    EXPECT_GT(carried.fitness, 0.8);
    const Pose error = step.T_to_from.inverse() * carried.T_to_from;
    EXPECT_LT(error.translation().norm(), 0.003);
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.002);
    for (const LabelPlane& plane : step.to.truth.planes) {
      const PixelSet expected = pixels_of_plane(step.to.truth, plane.id);
      if (expected.size() < 3000) continue;
      EXPECT_GT(test::iou(pixels_of_plane(carried.labels, plane.id), expected), 0.9)
          << "P" << plane.id;
      const LabelPlane* there = find_plane(carried.labels, plane.id);
      ASSERT_TRUE(there);
      EXPECT_EQ(there->origin, LabelOrigin::carried);
      EXPECT_GT(there->confidence, 0.9);
      EXPECT_GT(there->normal.dot(plane.normal), 0.999);
    }
  }
}

/// The largest plane of the first frame, labeled left of a column.
FrameLabels left_half(const Step& step, int& plane, int column) {
  plane = std::ranges::max_element(step.from.truth.planes, {}, [&](const LabelPlane& one) {
            return pixels_of_plane(step.from.truth, one.id).size();
          })->id;
  PixelSet pixels = pixels_of_plane(step.from.truth, plane);
  std::erase_if(pixels, [&](std::uint32_t i) {
    return static_cast<int>(i) % step.from.grid.width >= column;
  });
  return painted(empty_labels(step.from.grid, ""), step.from.grid, pixels, {plane},
                 PaintMode::over);
}

TEST(Carry, PlanesGrowToTheNewFramesEdgeButNotAcrossADrawnBorder) {
  Step step = step_in("corner", false);
  const lab::Scene scene = lab::make_scene("corner", 1);
  lab::CameraPose turned = scene.camera;
  turned.yaw_deg -= 15;
  step.to = test::view_of(scene, turned, false);
  const Pose T_from_to = lab::pose_of(scene.camera).inverse() * lab::pose_of(turned);
  CarryOptions options;
  options.T_to_from = T_from_to.inverse();
  int plane = 0;
  const FrameLabels labels = left_half(step, plane, 320);
  const CarriedLabels carried =
      carry_labels(step.from.frame, step.from.grid, labels, step.to.frame, step.to.grid,
                   empty_labels(step.to.grid, ""), options, {});
  std::size_t left = 0, grown = 0, right = 0, beyond = 0;
  for (const std::uint32_t i : pixels_of_plane(step.to.truth, plane)) {
    const Vec3d point = T_from_to * step.to.grid.points[i].cast<double>();
    const auto seen = step.from.grid.pixel_that_sees(point);
    const bool is_carried = carried.labels.plane.data[i] == plane;
    if (!seen && point.x() < 0) {  // left of the first frame's edge
      ++left;
      grown += is_carried;
    }
    if (seen && static_cast<int>(*seen) % step.from.grid.width > 324) {
      ++right;
      beyond += is_carried;
    }
  }
  ASSERT_GT(left, 1000u);
  ASSERT_GT(right, 1000u);
  EXPECT_GT(grown, left * 95 / 100);
  EXPECT_LT(beyond, 20u);
}

TEST(Carry, IsReproducible) {
  const Step step = step_in("stairs", true);
  const FrameLabels blank = empty_labels(step.to.grid, "");
  const CarriedLabels first = carry(step, step.from.truth, blank);
  const CarriedLabels second = carry(step, step.from.truth, blank);
  EXPECT_EQ(first.T_to_from.matrix(), second.T_to_from.matrix());
  EXPECT_EQ(first.labels.plane.data, second.labels.plane.data);
  EXPECT_EQ(first.labels.planes, second.labels.planes);
  EXPECT_EQ(first.doubt, second.doubt);
}

TEST(Carry, ExistingLabelsAreKept) {
  const Step step = step_in("corner", false);
  const FrameLabels blank = empty_labels(step.to.grid, "");
  const PixelSet mine = test::rectangle(step.to.grid, 300, 300, 340, 340);
  const FrameLabels existing = painted(blank, step.to.grid, mine, {1, Label::v}, PaintMode::over);
  const CarriedLabels carried = carry(step, step.from.truth, existing);
  for (const std::uint32_t i : mine)
    ASSERT_EQ(carried.labels.plane.data[i], step.to.grid.measured[i] ? 1 : 0) << i;
  EXPECT_EQ(find_plane(carried.labels, 1)->origin, LabelOrigin::hand);
}

TEST(Carry, APlaneThatDisappearedIsLeftToTheUser) {
  Step step = step_in("corner", false);
  // Another object is at the plane's position, so all of its labels are wrong.
  FrameLabels labels = empty_labels(step.from.grid, "");
  PixelSet slanted;
  for (const std::uint32_t i : test::rectangle(step.from.grid, 200, 200, 400, 400))
    if (step.from.grid.measured[i]) slanted.push_back(i);
  labels = painted(labels, step.from.grid, slanted, {7}, PaintMode::over);
  labels.planes[0].offset_m -= 0.3;
  const CarriedLabels carried = carry(step, labels, empty_labels(step.to.grid, ""));
  ASSERT_EQ(carried.planes.size(), 1u);
  EXPECT_EQ(carried.planes[0].pixels, 0u);
  EXPECT_GT(carried.planes[0].doubtful, 10000u);
  EXPECT_TRUE(carried.labels.planes.empty());
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(carried.doubt, 1)),
            carried.planes[0].doubtful);
}

TEST(Carry, IgnoredPixelsAndClassesWithoutAPlaneAreCarriedToo) {
  const Step step = step_in("corner", false);
  FrameLabels labels = empty_labels(step.from.grid, "");
  labels = painted(labels, step.from.grid, test::rectangle(step.from.grid, 200, 200, 300, 300),
                   {kPlaneIgnore}, PaintMode::over);
  labels = painted(labels, step.from.grid, test::rectangle(step.from.grid, 300, 200, 400, 300),
                   {0, Label::h}, PaintMode::over);
  const CarriedLabels carried = carry(step, labels, empty_labels(step.to.grid, ""));
  EXPECT_GT(std::ranges::count(carried.labels.plane.data, kPlaneIgnore), 8000);
  EXPECT_GT(std::ranges::count(carried.labels.hv.data, 1), 8000);
}

TEST(Carry, FramesOfDifferentScenesAreRejected) {
  Step step = step_in("corner", false);
  const lab::Scene other = lab::make_scene("stairs", 4);
  step.to = test::view_of(other, other.camera, false);
  for (auto& depth : step.to.frame.depth.data) depth = static_cast<std::uint16_t>(depth * 3);
  step.to.grid = make_label_grid(step.to.frame, step.to.truth.gravity);
  try {
    carry(step, step.from.truth, empty_labels(step.to.grid, ""));
    FAIL() << "carried";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("corner"), std::string::npos) << message;
    EXPECT_NE(message.find("expected at least 30 %"), std::string::npos) << message;
  }
}

TEST(Carry, CanBeStopped) {
  const Step step = step_in("corner", false);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(carry_labels(step.from.frame, step.from.grid, step.from.truth, step.to.frame,
                            step.to.grid, empty_labels(step.to.grid, ""), {}, stop.get_token()),
               Cancelled);
}

/// A camera that moves past boxes; frame 2 has no pose.
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

TEST(Spread, KeepsExistingLabelsAndCanBeStopped) {
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
