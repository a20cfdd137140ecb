// Tests of the segmentation method on small synthetic clouds.

#include "core/planes/segment/segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "support/scenes.hpp"

namespace planescope::planes {
namespace {

const Vec3d kSensor(-1.5, 0, 1);

/// Adds a rectangle with points every 2 cm, from `corner` along `u` and `v`.
void add_rectangle(test::LabeledCloud& cloud, Vec3d corner, Vec3d u, Vec3d v, Label label) {
  const int nu = static_cast<int>(u.norm() / 0.02), nv = static_cast<int>(v.norm() / 0.02);
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      cloud.points.push_back((corner + u * ((i + 0.5) / nu) + v * ((j + 0.5) / nv)).cast<float>());
      cloud.labels.push_back(label);
    }
}

/// A step 16 cm high: lower floor, riser, upper floor, each 0.6 m deep and 1 m wide.
test::LabeledCloud step() {
  test::LabeledCloud cloud;
  add_rectangle(cloud, {0, 0, 0}, {0.6, 0, 0}, {0, 1, 0}, Label::h);
  add_rectangle(cloud, {0.6, 0, 0}, {0, 0, 0.16}, {0, 1, 0}, Label::v);
  add_rectangle(cloud, {0.6, 0, 0.16}, {0.6, 0, 0}, {0, 1, 0}, Label::h);
  cloud.cube = test::cube_around(cloud.points);
  return cloud;
}

Segmentation run(const test::LabeledCloud& cloud,
                 const SegmentOptions& options,
                 Trace* trace = nullptr) {
  return segment(cloud.points, cloud.labels, cloud.cube, kSensor, options, trace);
}

TEST(Segment, AStepIsTwoTreadsAndARiser) {
  const Segmentation s = run(step(), profile_options(Profile::refined));
  ASSERT_EQ(s.planes.size(), 3u);
  std::map<int, int> h_levels;
  for (const PlaneRegion& p : s.planes) {
    if (p.label == Label::v) {
      EXPECT_NEAR(std::abs(p.fit.normal.x()), 1, 1e-6);
      EXPECT_LT(p.fit.normal.x(), 0) << "a riser looks at the sensor";
      EXPECT_NEAR(p.fit.centroid.x(), 0.6, 1e-3);
    } else {
      EXPECT_NEAR(p.fit.normal.z(), 1, 1e-6) << "a tread looks up";
      ++h_levels[static_cast<int>(std::lround(p.fit.centroid.z() * 100))];
    }
  }
  EXPECT_EQ(h_levels, (std::map<int, int>{{0, 1}, {16, 1}}));
  EXPECT_EQ(s.counts.unassigned, 0u);
}

TEST(Segment, PlanesAreNumberedBySize) {
  const Segmentation s = run(step(), profile_options(Profile::refined));
  for (std::size_t k = 0; k < s.planes.size(); ++k) {
    EXPECT_EQ(s.planes[k].id, static_cast<int>(k) + 1);
    EXPECT_EQ(s.planes[k].points, std::count(s.plane_of.begin(), s.plane_of.end(), s.planes[k].id));
    if (k > 0) {
      EXPECT_LE(s.planes[k].points, s.planes[k - 1].points);
    }
  }
}

TEST(Segment, EveryVisitedNodeIsSettledAndCounted) {
  const Segmentation s = run(test::random_cloud(11), profile_options(Profile::paper));
  EXPECT_EQ(s.counts.nodes_visited, s.octree.nodes.size());
  std::map<Case, std::uint32_t> cases;
  for (const OctreeNode& node : s.octree.nodes) {
    ++cases[node.decided];
    const bool divided = node.first_child >= 0;
    const bool must_divide = node.decided == Case::I || node.decided == Case::III;
    EXPECT_EQ(divided || node.at_max_depth, must_divide);
  }
  EXPECT_EQ(cases.count(Case::none), 0u);
  for (const auto& [c, n] : cases) EXPECT_EQ(n, s.counts.nodes_per_case[static_cast<int>(c)]);
}

TEST(Segment, TracingDoesNotChangeTheResult) {
  for (const Profile profile : {Profile::paper, Profile::paper_closest, Profile::refined}) {
    const test::LabeledCloud cloud = test::random_cloud(21);
    Trace trace;
    const Segmentation with = run(cloud, profile_options(profile), &trace);
    const Segmentation without = run(cloud, profile_options(profile));
    EXPECT_EQ(with.plane_of, without.plane_of);
    ASSERT_EQ(with.planes.size(), without.planes.size());
    for (std::size_t k = 0; k < with.planes.size(); ++k)
      EXPECT_EQ(with.planes[k].fit.normal, without.planes[k].fit.normal);
    EXPECT_FALSE(trace.events.empty());
  }
}

TEST(Segment, TheTraceIsComplete) {
  const test::LabeledCloud cloud = test::random_cloud(22);
  Trace trace;
  const Segmentation s = run(cloud, profile_options(Profile::paper), &trace);
  std::map<EventType, std::uint32_t> events;
  std::vector<int> plane_of_leftover(cloud.points.size(), -2);
  for (const TraceEvent& e : trace.events) {
    ++events[e.type];
    if (e.type == EventType::assign || e.type == EventType::drop)
      plane_of_leftover[e.point] = e.plane;
  }
  EXPECT_EQ(events[EventType::visit], s.counts.nodes_visited);
  EXPECT_EQ(events[EventType::decide], s.counts.nodes_visited);
  EXPECT_EQ(events[EventType::found], s.planes.size());
  EXPECT_EQ(events[EventType::found] + events[EventType::merge], s.counts.nodes_per_case[4]);
  EXPECT_EQ(events[EventType::assign] + events[EventType::drop], s.counts.leftovers);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (plane_of_leftover[i] == -2) continue;
    const int plane = s.plane_of[i] == 0 ? -1 : s.planes[s.plane_of[i] - 1].founded;
    EXPECT_EQ(plane, plane_of_leftover[i]);
  }
}

TEST(Segment, LeftoversOfThePaperJoinTheFirstPlaneWithinRangeWithoutRefitting) {
  // A floor, with one v point 4 mm above it and one 6 mm above it.
  test::LabeledCloud cloud;
  add_rectangle(cloud, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, Label::h);
  const auto near = cloud.points.size();
  cloud.points.push_back({0.501f, 0.501f, 0.004f});
  cloud.points.push_back({0.301f, 0.301f, 0.006f});
  cloud.labels.insert(cloud.labels.end(), 2, Label::v);
  cloud.cube = test::cube_around(cloud.points);
  const Segmentation s = run(cloud, profile_options(Profile::paper));
  ASSERT_EQ(s.planes.size(), 1u);
  EXPECT_EQ(s.plane_of[near], 1);
  EXPECT_EQ(s.plane_of[near + 1], 0);
  EXPECT_EQ(s.planes[0].fit.count, static_cast<double>(near));
  EXPECT_NEAR(s.planes[0].fit.eigenvalues[0], 0, 1e-12);
  EXPECT_EQ(s.counts.unassigned, 1u);
}

TEST(Segment, AFarKerbIsMergedAsWrittenButSeparatedByRefined) {
  // A floor and the top of a kerb beside it, 12 cm high, seen from above, without points between
  // them.
  test::LabeledCloud cloud;
  add_rectangle(cloud, {0, 0, 0}, {1.2, 0, 0}, {0, 1, 0}, Label::h);
  add_rectangle(cloud, {1.4, 0, 0.12}, {1.2, 0, 0}, {0, 1, 0}, Label::h);
  cloud.cube = test::cube_around(cloud.points);
  SegmentOptions paper = profile_options(Profile::paper);
  EXPECT_EQ(run(cloud, paper).planes.size(), 1u);
  EXPECT_EQ(run(cloud, profile_options(Profile::refined)).planes.size(), 2u);
}

/// Two tables of the same height, half a meter apart.
test::LabeledCloud two_tables() {
  test::LabeledCloud cloud;
  add_rectangle(cloud, {0, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, Label::h);
  add_rectangle(cloud, {1, 0, 0}, {0.8, 0, 0}, {0, 1, 0}, Label::h);
  cloud.cube = test::cube_around(cloud.points);
  return cloud;
}

TEST(Segment, SeparatePartsOfACloudAreSplit) {
  test::LabeledCloud cloud = two_tables();
  EXPECT_EQ(run(cloud, profile_options(Profile::refined)).planes.size(), 2u);
  for (Vec3f& p : cloud.points) p = Vec3f(p.x(), p.z(), p.y());  // two vertical boards
  for (Label& label : cloud.labels) label = Label::v;
  cloud.cube = test::cube_around(cloud.points);
  EXPECT_EQ(run(cloud, profile_options(Profile::refined)).planes.size(), 2u);
}

TEST(Segment, ASparseCloudIsNotSplitBetweenItsPoints) {
  test::LabeledCloud cloud;
  for (double x = 0; x < 1.5; x += 0.07)
    for (double y = 0; y < 1; y += 0.07)
      for (const double z : {0.0, -0.5}) {
        cloud.points.push_back(Vec3d(x, y, z).cast<float>());
        cloud.labels.push_back(Label::h);
      }
  cloud.cube = test::cube_around(cloud.points);
  EXPECT_EQ(run(cloud, profile_options(Profile::refined)).planes.size(), 2u);
}

TEST(Segment, WithoutLabelsLabelsAreIgnored) {
  for (const Profile profile : {Profile::paper, Profile::paper_closest, Profile::refined})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      test::LabeledCloud cloud = test::random_cloud(seed);
      SegmentOptions options = profile_options(profile);
      options.use_labels = false;
      const Segmentation labeled = run(cloud, options);
      std::fill(cloud.labels.begin(), cloud.labels.end(), Label::h);
      EXPECT_EQ(run(cloud, options).plane_of, labeled.plane_of) << to_string(profile) << seed;
    }
}

TEST(Segment, DegenerateInputsAreHandled) {
  for (const Profile profile : {Profile::paper, Profile::paper_closest, Profile::refined}) {
    const SegmentOptions options = profile_options(profile);
    EXPECT_TRUE(segment({}, {}, Cube{}, kSensor, options).planes.empty());

    test::LabeledCloud same;  // more points at one position than any threshold
    same.points.assign(100, Vec3f(1, 1, 1));
    same.labels.assign(100, Label::h);
    for (std::size_t i = 0; i < 50; ++i) same.labels[i] = Label::v;
    const Segmentation s = run(same, options);
    EXPECT_EQ(s.plane_of.size(), 100u);

    test::LabeledCloud line;  // collinear
    for (int i = 0; i < 60; ++i) line.points.push_back(Vec3f(0.02f * static_cast<float>(i), 1, 1));
    line.labels.assign(60, Label::h);
    for (const PlaneRegion& p : run(line, options).planes) EXPECT_TRUE(p.fit.normal.allFinite());
  }
}

}  // namespace
}  // namespace planescope::planes
