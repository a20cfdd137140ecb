// Tests of the tracker, observations, fusion and maps.

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "core/io/recording.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/world/files/map_files.hpp"
#include "core/world/tracks/tracker.hpp"
#include "support/temp_dir.hpp"

namespace planescope::world {
namespace {

planes::PipelineOptions pca_options() {
  planes::PipelineOptions options;
  options.classifier = "pca";
  return options;
}

/// An error of a camera's pose.
Pose off_by(const Vec3d& shift, double turn_rad = 0) {
  Pose off = Pose::Identity();
  off.linear() = Eigen::AngleAxisd(turn_rad, Vec3d::UnitY()).toRotationMatrix();
  off.translation() = shift;
  return off;
}

/// A map of the first frames of a recording.
struct MapOf {
  planes::ChosenClassifier chosen = planes::make_classifier(pca_options(), {});
  MapJob job;

  MapOf(const io::Recording& recording, int frames) {
    job.recording = &recording;
    job.pipeline = pca_options();
    job.classifier = chosen.classifier.get();
    for (int i = 0; i < frames; ++i) job.frames.push_back(i);
  }
};

/// A box on a floor in front of a wall, seen by a camera.
class Room : public ::testing::Test {
 protected:
  Room() {
    lab::add_ground(scene_, {{-2, 4}, {-3, 3}});
    lab::add_polygon(scene_, lab::upright({1.6, 3}, {1.6, -3}, {0, 2}), {});
    empty_ = scene_;
    lab::add_box(scene_, {0.9, 0, 0}, {0.3, 0.4, 0.3}, 10, {});
    camera_.pitch_deg = 35;
    model_.intrinsics = lab::d435_intrinsics(160, 120);
    model_.noise = model_.color = false;
  }

  Frame render(const lab::Scene& scene) const {
    return lab::render_scene(scene, camera_, model_, static_cast<std::uint64_t>(1 + next_));
  }
  ObservedFrame look(const lab::Scene& scene,
                     bool covered = false,
                     std::span<const Track* const> known = {}) {
    Frame frame = render(scene);
    if (covered) std::ranges::fill(frame.depth.data, std::uint16_t{0});
    frame.index = next_++;
    const Pose pose = lab::pose_of(camera_);
    frame.gravity =
        Gravity{pose.linear().transpose() * -Vec3d::UnitZ(), GravitySource::sidecar, 1, ""};
    const std::vector<planes::KnownPlane> expected =
        expected_planes(known, frame, pose, tracker_.options());
    const auto result =
        planes::run_frame(frame, options_, chosen_.classifier.get(), nullptr, nullptr, expected);
    return observe(frame, result, options_, pose, 0);
  }
  const Track& track_of(const Vec3d& place, const Vec3d& normal) {
    for (const Track& track : tracker_.tracks())
      if (track.state != TrackState::merged && std::abs(track.distance_m(place)) < 0.02 &&
          track.fit.normal.dot(normal) > 0.98)
        return track;
    ADD_FAILURE() << "no track";
    return tracker_.tracks().front();
  }
  const Track& floor() { return track_of(Vec3d::Zero(), Vec3d::UnitZ()); }
  const Track& lid() { return track_of({0.9, 0, 0.3}, Vec3d::UnitZ()); }

  lab::Scene scene_, empty_;
  lab::CameraPose camera_;
  lab::D435Model model_;
  planes::PipelineOptions options_ = pca_options();
  planes::ChosenClassifier chosen_ = planes::make_classifier(options_, {});
  Tracker tracker_;
  int next_ = 0;
};

TEST_F(Room, PlanesKeepTheirTracksFromFrameToFrame) {
  for (int i = 0; i < 6; ++i) {
    camera_.position.x() = 0.02 * i;
    camera_.yaw_deg = i;
    ObservedFrame seen = look(scene_);
    for (ObservedPlane& plane : seen.planes) plane.undecided = i == 2;
    tracker_.add(seen);
  }
  EXPECT_EQ(floor().frames_undecided(), 1);
  EXPECT_TRUE(floor().sightings[2].undecided);
  EXPECT_EQ(floor().frames_seen, 6);
  EXPECT_EQ(lid().frames_seen, 6);
  EXPECT_TRUE(lid().gaps.empty());
  EXPECT_LT(std::abs(floor().distance_m(Vec3d::Zero())), 0.002);
  // The lid's true size is 0.3 m by 0.4 m.
  EXPECT_NEAR(outline_of(lid()).area_m2, 0.12, 0.015);
  for (const Track& track : tracker_.tracks())
    EXPECT_EQ(track.is_sure({}) ? track.frames_missed : 0, 0) << track.id;
}

TEST_F(Room, MinorPlanesContinueTracksButStartNone) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  const std::size_t tracks = tracker_.tracks().size();
  const double measured = floor().moments.count;
  double& least = options_.segment.objective.worth_px;
  ObservedFrame minor = look(scene_);
  const auto lists = [](const ObservedFrame& frame) {
    return std::ranges::any_of(frame.planes, [](const ObservedPlane& p) { return !p.minor; });
  };
  for (; lists(minor); minor = look(scene_)) least *= 1.3;  // the floor is worth the most
  const FrameOfTracks& reported = tracker_.add(minor);
  EXPECT_EQ(reported.listed, 0);
  EXPECT_EQ(tracker_.tracks().size(), tracks);
  EXPECT_EQ(floor().frames_seen, 5);
  EXPECT_TRUE(floor().sightings.back().minor);
  EXPECT_TRUE(floor().gaps.empty());
  EXPECT_EQ(floor().moments.count, measured);
  Tracker other;
  other.add(minor);
  EXPECT_TRUE(other.tracks().empty());
}

TEST_F(Room, LabelsFromTheMapAreTheFramesMeasurementsOfATrack) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  camera_.position.y() = 0.3;
  const labels::LabelGrid grid = labels::make_label_grid(render(scene_), Gravity{});
  const Pose pose = lab::pose_of(camera_);
  const PixelsOfTrack found = pixels_of_track(lid(), grid, pose);
  const auto on_lid = [&](std::uint32_t i) {
    const Vec3d p = pose * grid.points[i].cast<double>();
    return grid.measured[i] && p.x() < 1.3 && std::abs(p.z() - 0.3) < 0.003;
  };
  std::size_t all = 0;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i) all += on_lid(i);
  const auto right = static_cast<std::size_t>(std::ranges::count_if(found.sure, on_lid));
  EXPECT_GT(right, 9 * all / 10);
  EXPECT_GT(right, 98 * found.sure.size() / 100);
  EXPECT_LT(found.doubtful.size(), all / 6);
}

TEST_F(Room, ACoveredCameraLosesNothing) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  const int before = lid().id;
  for (int i = 0; i < 10; ++i) tracker_.add(look(scene_, true));
  tracker_.add(look(scene_));
  EXPECT_EQ(lid().id, before);
  EXPECT_EQ(lid().frames_seen, 5);
  ASSERT_EQ(lid().gaps.size(), 1u);
  EXPECT_EQ(lid().gaps[0].why, Absence::not_measured);
  EXPECT_EQ(lid().gaps[0].frames, 10);
  EXPECT_EQ(lid().frames_missed, 0);
}

TEST_F(Room, ARemovedObjectIsGoneAndItsTrackIsKept) {
  for (int i = 0; i < 5; ++i) tracker_.add(look(scene_));
  const int id = lid().id;
  for (int i = 0; i < 8; ++i) tracker_.add(look(empty_));
  const Track& gone = tracker_.tracks()[id - 1];
  EXPECT_EQ(gone.state, TrackState::gone);
  ASSERT_FALSE(gone.gaps.empty());
  EXPECT_EQ(gone.gaps[0].why, Absence::seen_through);
  EXPECT_TRUE(gone.is_sure({}));
  EXPECT_NEAR(outline_of(gone).area_m2, 0.12, 0.02);
  EXPECT_EQ(floor().state, TrackState::alive);
}

TEST_F(Room, AFrameAtAWrongPoseIsSetAside) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  const std::size_t tracks = tracker_.tracks().size();
  ObservedFrame wrong = look(scene_);
  move_to(wrong, off_by({0, 0, 0.3}) * wrong.T_world_camera);
  const FrameOfTracks& reported = tracker_.add(wrong);
  EXPECT_TRUE(reported.set_aside);
  EXPECT_LT(reported.agreement, 0.35);
  EXPECT_EQ(tracker_.tracks().size(), tracks);
  EXPECT_EQ(floor().gaps.back().why, Absence::set_aside);
  EXPECT_FALSE(tracker_.add(look(scene_)).set_aside);
  Tracker begun_wrong;  // takes one more frame
  begun_wrong.add(wrong);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(begun_wrong.add(look(scene_)).set_aside, i == 0) << i;
  EXPECT_EQ(begun_wrong.frames().back().segment, 1);
}

TEST_F(Room, AFrameAtASlightlyWrongPoseIsAligned) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  ObservedFrame seen = look(scene_);
  const Pose right = seen.T_world_camera;
  move_to(seen, off_by({0.02, 0, 0.02}, 0.01) * right);
  const Pose aligned = tracker_.add(seen).T_world_camera;
  EXPECT_LT((aligned.translation() - right.translation()).norm(), 0.003);
  EXPECT_LT(Eigen::AngleAxisd(aligned.linear().transpose() * right.linear()).angle(), 0.002);
  EXPECT_LT(std::abs(floor().distance_m(Vec3d::Zero())), 0.002);
  EXPECT_EQ(floor().frames_seen, 5);
  // A frame that fits is not moved.
  const ObservedFrame fitting = look(scene_);
  EXPECT_EQ(tracker_.add(ObservedFrame(fitting)).T_world_camera.matrix(),
            fitting.T_world_camera.matrix());
}

TEST_F(Room, TheFloorBeforeALowWallDoesNotShiftIt) {
  lab::Scene low;
  lab::add_ground(low, {{-2, 4}, {-3, 3}});
  lab::add_polygon(low, lab::upright({1.2, 2}, {1.2, -2}, {0, 0.15}), {});
  for (int i = 0; i < 4; ++i) tracker_.add(look(low));
  Track wall = track_of({1.2, 0, 0.1}, -Vec3d::UnitX());
  Track* const alone[] = {&wall};
  // If its pose is too high, the camera sees floor at the wall's foot.
  ObservedFrame seen = look(low);
  const Pose right = seen.T_world_camera;
  move_to(seen, off_by({0.02, 0, 0.05}) * right);
  const Pose aligned = aligned_pose(seen, alone);
  EXPECT_LT(std::abs((aligned.translation() - right.translation()).x()), 0.012);
}

TEST_F(Room, TheFloorIsExpectedWhereItIsVisible) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  Frame frame;
  frame.intrinsics = lab::d435_intrinsics(160, 120);
  const ObservedFrame seen = look(scene_);
  frame.depth = seen.depth;
  const Track* const known[] = {&floor()};
  const std::vector<planes::KnownPlane> expected =
      expected_planes(known, frame, seen.T_world_camera, tracker_.options(), 2);
  ASSERT_EQ(expected.size(), 1u);
  EXPECT_EQ(expected[0].id, floor().id);
  const std::set<std::uint32_t> pixels(expected[0].pixels.begin(), expected[0].pixels.end());
  EXPECT_EQ(pixels.size(), expected[0].pixels.size()) << "each once";
  const int id = floor().sightings.back().plane;
  std::vector<std::uint32_t> of_floor, both;
  for (std::uint32_t pixel = 0; pixel < seen.plane_of.data.size(); ++pixel)
    if (seen.plane_of.data[pixel] == id) of_floor.push_back(pixel);
  std::ranges::set_intersection(of_floor, pixels, std::back_inserter(both));
  const auto floor_px = static_cast<double>(of_floor.size());
  EXPECT_GT(floor_px, 5000);
  EXPECT_GT(static_cast<double>(both.size()), 0.97 * floor_px);
  EXPECT_LT(static_cast<double>(pixels.size() - both.size()), 0.05 * floor_px);
}

TEST_F(Room, TracksOfAnEarlierPassKeepTheirPlanes) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  tracker_.consolidate();
  Tracker second({}, tracker_.tracks().size());
  for (int i = 0; i < 4; ++i) {
    std::vector<const Track*> known;
    for (const Track& track : tracker_.tracks())
      if (track.is_sure(tracker_.options())) known.push_back(&track);
    ObservedFrame seen = look(scene_, false, known);
    std::set<int> expected;
    for (const ObservedPlane& plane : seen.planes)
      if (plane.known > 0) expected.insert(plane.known);
    EXPECT_EQ(expected.size(), known.size()) << i;
    const FrameOfTracks& reported = second.add(seen);
    for (const ObservedPlane& plane : seen.planes) {
      if (plane.known == 0) continue;
      EXPECT_EQ(second.tracks()[reported.track_of[plane.id - 1] - 1].known, plane.known) << i;
    }
  }
  for (const Track& track : second.tracks()) EXPECT_EQ(track.frames_missed, 0) << track.id;
}

TEST_F(Room, TracksThatLeaveTheWindowAreReturnedAndForgotten) {
  TrackOptions options;
  options.window_m = 3;
  tracker_ = Tracker(options);
  std::vector<LeftPiece> left;
  tracker_.on_left([&](const LeftPiece& piece) { left.push_back(piece); });
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  EXPECT_TRUE(left.empty());
  const double lid_m2 = lid().sure_area_m2();
  const int id = lid().id;
  camera_.position.x() -= 3;
  ObservedFrame away = look(scene_);
  tracker_.add(away);
  const Track& track = tracker_.tracks()[id - 1];
  EXPECT_EQ(track.state, TrackState::left);
  EXPECT_EQ(track.cells.present(), 0u);
  EXPECT_NEAR(track.left_m2, lid_m2, 1e-9);
  EXPECT_TRUE(track.is_sure(options)) << "the map still knows of it";
  const auto piece = std::ranges::find(left, id, &LeftPiece::track);
  ASSERT_NE(piece, left.end());
  EXPECT_NEAR(piece->outline.area_m2, lid_m2, 0.01);
}

TEST_F(Room, AMissReportsTheTermThatFailed) {
  for (int i = 0; i < 4; ++i) tracker_.add(look(scene_));
  ObservedFrame tilted = look(scene_);
  const int floor_plane = floor().sightings.back().plane;
  ObservedPlane& plane = tilted.planes[floor_plane - 1];
  const Mat3d turn = Eigen::AngleAxisd(0.4, Vec3d::UnitY()).toRotationMatrix();
  const Vec3d from_camera = plane.centroid - tilted.camera();
  Pose about_centroid = Pose::Identity();
  about_centroid.linear() = turn;
  about_centroid.translation() = from_camera - turn * from_camera;
  plane.normal = turn * plane.normal;
  plane.moments = moved(plane.moments, about_centroid);
  const int id = floor().id;
  tracker_.add(tilted);
  const Track& track = tracker_.tracks()[id - 1];
  ASSERT_FALSE(track.gaps.empty());
  EXPECT_EQ(track.gaps.back().why, Absence::not_matched);
  EXPECT_EQ(track.gaps.back().plane, floor_plane);
  EXPECT_EQ(track.gaps.back().term.failed, Term::angle_deg);
  EXPECT_NEAR(track.gaps.back().term.value, 22.9, 0.5);
  EXPECT_LT(track.gaps.back().term.threshold, track.gaps.back().term.value);
}

TEST(CellMap, IgnoresPositionsBeyondTheRangeOfInt) {
  CellMap cells(0.02);
  EXPECT_EQ(cells.index_of(-0.03), -2);
  EXPECT_EQ(cells.index_of(2e5), 10'000'000);  // twice the limit on poses
  const planes::PolygonRing far = {{1e12, 1e12}, {2e12, 1e12}, {2e12, 2e12}};
  int visited = 0;
  cells.fill(std::vector<planes::PolygonRing>{far}, [&](int, int) { ++visited; });
  EXPECT_EQ(visited, 0);
  for (const double beyond : {1e300, -1e300, std::nan("")})
    cells.at(cells.index_of(beyond), cells.index_of(beyond)).see();
}

TEST(Fusion, OfMomentsEqualsAFitToAllPoints) {
  // Points seen from two positions, each relative to its own camera.
  Moments all, parts;
  for (int k = 0; k < 2; ++k) {
    const Vec3d camera(k, 0.5 * k, 1);
    Moments own;
    for (int i = 0; i < 100; ++i) {
      const Vec3d p(0.1 * (i % 10) + k, 0.1 * (i / 10), 0.2 + 0.001 * ((7 * i + k) % 5));
      all.add(p);
      own.add(p - camera);
    }
    const PlaneFit fit = fit_plane(own);
    EXPECT_EQ(fit.count, 100);
    Pose to_world = Pose::Identity();
    to_world.translation() = camera;
    parts += moved(own, to_world);
  }
  const PlaneFit at_once = fit_plane(all), added = fit_plane(parts);
  EXPECT_TRUE(added.normal.isApprox(at_once.normal, 1e-9));
  EXPECT_TRUE(added.centroid.isApprox(at_once.centroid, 1e-12));
  EXPECT_NEAR(added.eigenvalues[0], at_once.eigenvalues[0], 1e-10);
}

TEST(Fusion, ShrinksTheUncertainty) {
  Track track(0.02);
  track.basis = plane_basis(Vec3d::UnitZ());
  ObservedPlane plane;
  for (int i = 0; i < 50; ++i) plane.moments.add(Vec3d(0.1 * (i % 7), 0.1 * (i / 7), -1));
  plane.certainty.sigma_m = 0.002;
  plane.certainty.sigma_offset_m = 0.004;
  plane.certainty.sigma_tilt_rad[0] = plane.certainty.sigma_tilt_rad[1] = 0.01;
  track.fuse(plane, Vec3d(0, 0, 1));
  const double once_m = track.sigma_m(Vec2d::Zero()), once_deg = track.sigma_tilt_deg();
  for (int i = 0; i < 15; ++i) track.fuse(plane, Vec3d(0, 0, 1));
  // A quarter, plus the error common to all frames.
  EXPECT_NEAR(track.sigma_m(Vec2d::Zero()), std::hypot(0.001, 0.001), 1e-4);
  EXPECT_LT(track.sigma_m(Vec2d::Zero()), once_m / 2);
  EXPECT_LT(track.sigma_tilt_deg(), once_deg / 2);
}

TEST(Fusion, OfFewNoisyMeasurementsHasTheirNormal) {
  Track track(0.02);
  track.basis = plane_basis(Vec3d::UnitX());
  ObservedPlane plane;
  for (int i = 0; i < 50; ++i) plane.moments.add(Vec3d(-1, 0.02 * (i % 7), 0.02 * (i / 7)));
  plane.certainty.sigma_m = 0.02;
  track.fuse(plane, Vec3d(1, 0, 0));
  EXPECT_TRUE(track.fit.normal.isApprox(Vec3d::UnitX(), 1e-6));
  EXPECT_GT(track.width_m(), 0.1);
}

/// A level rectangle around `centroid`, whose tilt about y has the uncertainty `sigma_tilt_rad`.
ObservedPlane level_plane(int id, const Vec3d& centroid, const Vec2d& size, double sigma_tilt_rad) {
  ObservedPlane plane;
  plane.id = id;
  plane.label = Label::h;
  plane.centroid = centroid;
  std::vector<Vec2d> places;
  for (double x = -size.x() / 2; x <= size.x() / 2; x += 0.02)
    for (double y = -size.y() / 2; y <= size.y() / 2; y += 0.02) {
      places.emplace_back(x, y);
      plane.moments.add(centroid + Vec3d(x, y, 0));
    }
  plane.certainty.axes[0] = Vec3d::UnitY();
  plane.certainty.axes[1] = Vec3d::UnitX();
  plane.certainty.sigma_m = 0.005;
  plane.certainty.sigma_offset_m = 0.001;
  plane.certainty.sigma_tilt_rad[1] = sigma_tilt_rad;
  plane.outline =
      planes::outline_of_points(centroid, {Vec3d::UnitX(), Vec3d::UnitY()}, places, 0.02);
  return plane;
}

TEST(Tracker, AStripOfUnknownTiltIsNotMergedWithAFloorBelowIt) {
  // Like the first view of a tread: extended to the floor's center, it could have any height.
  ObservedFrame frame;
  frame.planes = {level_plane(1, {0, 0, 0}, {1, 1}, 0.001),
                  level_plane(2, {0.56, 0, 0.1}, {0.06, 0.5}, 0.1)};
  frame.plane_of = frame.depth = Image16(1, 1);
  Tracker tracker;
  EXPECT_EQ(tracker.add(frame).track_of, (std::vector{1, 2}));
  EXPECT_EQ(tracker.tracks()[1].state, TrackState::alive);
}

TEST_F(Room, ALowBoardIsNotTilted) {
  // Seen from above, with errors along the rays: a fit to all of its points in space is off by 0.7.
  lab::Scene scene;
  lab::add_polygon(scene, lab::upright({1.1, 0.6}, {1.1, -0.6}, {0.05, 0.2}), {});
  camera_.pitch_deg = 30;
  model_ = {};
  model_.color = false;
  for (int i = 0; i < 8; ++i) tracker_.add(look(scene));
  ASSERT_EQ(tracker_.tracks().size(), 1u);
  const Track& board = tracker_.tracks().front();
  EXPECT_EQ(board.frames_seen, 8);
  EXPECT_NEAR(std::asin(board.fit.normal.z()) * 180 / std::numbers::pi, 0, 0.4);
}

TEST(Map, OfAWalkIsTheSameForAnyNumberOfThreads) {
  lab::SequenceOptions walk;
  walk.width = 160;
  walk.height = 120;
  walk.frames = 60;
  walk.color = false;
  const auto dir = temp_dir() / "walk";
  lab::write_sequence(dir, walk, 2);
  const auto recording = io::open_recording(dir);
  MapOf walked(*recording, 24);
  MapJob& job = walked.job;
  std::map<int, std::vector<unsigned char>> pngs;
  job.on_planes = [&](int frame, std::span<const unsigned char> png) {
    pngs[frame].assign(png.begin(), png.end());
  };
  const WorldMap one = map_recording(job);
  EXPECT_EQ(pngs.size(), job.frames.size());
  job.threads = 3;
  const WorldMap three = map_recording(job);
  EXPECT_EQ(map_texts(one, "walk").map_json, map_texts(three, "walk").map_json);
  EXPECT_EQ(map_texts(one, "walk").tracks_json, map_texts(three, "walk").tracks_json);
  EXPECT_EQ(one.poses.source, "the recording");
  EXPECT_GT(planes_of_map(one.tracker).size(), 4u);
  // The planes of each frame are stored, with the tracks of the final pass.
  ASSERT_EQ(one.stored.size(), job.frames.size());
  for (const int frame : job.frames) {
    const StoredPlanes& stored = one.stored.at(frame);
    EXPECT_EQ(stored.sha256, three.stored.at(frame).sha256) << frame;
    EXPECT_EQ(stored.sha256, sha256_hex(std::as_bytes(std::span(pngs[frame])))) << frame;
    EXPECT_EQ(stored.margins.size(), one.tracker.frames()[frame].track_of.size()) << frame;
  }
}

TEST(Odometry, FollowsAWalkOverAFloor) {
  // Little more than the floor is visible, so that depth determines neither position nor heading.
  constexpr std::size_t kFirst = 36, kFrames = 14;
  lab::SequenceOptions walk;
  walk.width = 320;
  walk.height = 240;
  walk.frames = 300;
  const auto dir = temp_dir() / "steps";
  const lab::Sequence sequence = lab::make_sequence(walk);
  lab::SampleFolder folder{"test", 1, kFrames, true, false};
  lab::write_sample_folder(dir, folder, [&](std::size_t i) {
    lab::SampleFrame frame = lab::make_sequence_frame(walk, sequence, kFirst + i);
    frame.T_world_camera.reset();
    return frame;
  });
  const auto recording = io::open_recording(dir);
  const WorldMap map = map_recording(MapOf(*recording, recording->frame_count()).job);
  EXPECT_EQ(map.poses.source, "odometry");
  ASSERT_EQ(map.poses.poses.size(), kFrames);
  const Pose before = lab::pose_of(sequence.cameras[kFirst]),
             after = lab::pose_of(sequence.cameras[kFirst + kFrames - 1]);
  const Pose reported =
      map.poses.poses.front().T_world_camera.inverse() * map.poses.poses.back().T_world_camera;
  const Pose off = (before.inverse() * after).inverse() * reported;
  EXPECT_LT(off.translation().norm(), 0.02 * (before.inverse() * after).translation().norm());
  EXPECT_LT(turn_deg(off), 0.5);
  // z points up, regardless of the first camera's axes.
  EXPECT_GT(map.poses.poses[0].T_world_camera.linear().col(1).dot(-Vec3d::UnitZ()), 0.7);
}

}  // namespace
}  // namespace planescope::world
