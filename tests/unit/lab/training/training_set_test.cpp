// Tests of training sets, recipes, test scans and augmentation.

#include "core/lab/training/training_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "core/lab/synthetic/scenes.hpp"
#include "core/model/plane.hpp"

namespace planescope::lab {
namespace {

TrainingSetOptions objects(int stairs, int boxes, int planes) {
  TrainingSetOptions options;
  options.stairs = stairs;
  options.boxes = boxes;
  options.planes = planes;
  options.scans = 0;
  return options;
}

TrainingSetOptions one_of_each() {
  TrainingSetOptions options = objects(1, 1, 1);
  options.scans = 2;
  options.points = 512;
  return options;
}

Bounds bounds_of(const planes::LabeledCloud& cloud) {
  Bounds bounds;
  for (const Vec3f& p : cloud.points) bounds.add(p.cast<double>());
  return bounds;
}

/// Distance within which a cloud's points reach the ends of its surface.
constexpr double kEndM = 0.025;

void expect_within(double value, double low, double high) {
  EXPECT_GE(value, low - kEndM);
  EXPECT_LE(value, high + 1e-4);
}

bool same(const planes::LabeledCloud& a, const planes::LabeledCloud& b) {
  return a.kind == b.kind && a.points == b.points && a.labels == b.labels;
}

TEST(TrainingSet, HasThePapersNumbersOfObjectsByDefault) {
  const TrainingSetOptions paper;
  EXPECT_EQ(std::vector({paper.stairs, paper.boxes, paper.planes}), std::vector(3, 200));
  TrainingSetOptions options = objects(3, 2, 1);
  options.points = 16;
  std::string kinds;
  for (const planes::LabeledCloud& cloud : make_training_set(options, 2)) {
    kinds += cloud.kind + " ";
    EXPECT_EQ(cloud.points.size(), 16u);
    EXPECT_EQ(cloud.labels.size(), 16u);
  }
  EXPECT_EQ(kinds, "stairs stairs stairs box box plane ");
}

TEST(TrainingSet, StairsHaveThePapersSteps) {
  std::set<int> counts;
  for (const planes::LabeledCloud& cloud : make_training_set(objects(30, 0, 0), 2)) {
    // Axis-aligned: each tread has a height, each riser a distance, and the first riser is at 0.
    std::set<float> heights, risers;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (cloud.labels[i] == Label::h) heights.insert(cloud.points[i].z());
      if (cloud.labels[i] == Label::v) risers.insert(cloud.points[i].x());
    }
    ASSERT_EQ(heights.size(), risers.size());
    const auto steps = static_cast<int>(heights.size());
    counts.insert(steps);
    EXPECT_GE(steps, 2);
    EXPECT_LE(steps, 6);
    const double height = static_cast<double>(*heights.rbegin()) / steps;
    EXPECT_TRUE(height >= 0.08 && height <= 0.3) << height;
    const double length = static_cast<double>(*risers.rbegin()) / (steps - 1);
    EXPECT_TRUE(length >= 0.2 && length <= 0.4) << length;
    const Bounds bounds = bounds_of(cloud);
    expect_within(bounds.max.y() - bounds.min.y(), 0.2, 1.5);
  }
  EXPECT_EQ(counts, (std::set<int>{2, 3, 4, 5, 6}));
}

TEST(TrainingSet, BoxesHaveATopAndFourSidesAndHalfAreOnAFloor) {
  int on_floor = 0;
  for (const planes::LabeledCloud& cloud : make_training_set(objects(0, 40, 0), 2)) {
    Bounds top;
    std::map<float, int> x_of_sides, y_of_sides;
    bool floor = false;
    const double height = bounds_of(cloud).max.z();
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vec3f& p = cloud.points[i];
      if (cloud.labels[i] == Label::v) {
        ++x_of_sides[p.x()];
        ++y_of_sides[p.y()];
      } else if (p.z() == 0) {
        floor = true;
      } else {
        EXPECT_EQ(p.z(), static_cast<float>(height));
        top.add(p.cast<double>());
      }
    }
    on_floor += floor;
    EXPECT_TRUE(height >= 0.08 && height <= 0.3) << height;
    expect_within(top.max.x() - top.min.x(), 0.1, 2);
    expect_within(top.max.y() - top.min.y(), 0.1, 2);
    const auto has_side = [](const std::map<float, int>& sides, double at) {
      return std::any_of(sides.begin(), sides.end(), [&](const auto& side) {
        return side.second > 3 && std::abs(side.first - at) < kEndM;
      });
    };
    EXPECT_TRUE(has_side(x_of_sides, top.min.x()) && has_side(x_of_sides, top.max.x()));
    EXPECT_TRUE(has_side(y_of_sides, top.min.y()) && has_side(y_of_sides, top.max.y()));
  }
  EXPECT_NEAR(on_floor, 20, 10);
}

TEST(TrainingSet, PlanesHaveAnyInclinationAndTheMatchingLabel) {
  double sum_z = 0, least_z = 1, most_z = 0;
  for (const planes::LabeledCloud& cloud : make_training_set(objects(0, 0, 40), 2)) {
    Moments moments;
    for (const Vec3f& p : cloud.points) moments.add(p.cast<double>());
    const PlaneFit fit = fit_plane(moments);
    EXPECT_LT(fit.rms_m(), 1e-6);
    const double z = std::abs(fit.normal.z());
    const Label label = z >= std::sqrt(0.5) ? Label::h : Label::v;
    EXPECT_EQ(std::count(cloud.labels.begin(), cloud.labels.end(), label), 8192);
    sum_z += z;
    least_z = std::min(least_z, z);
    most_z = std::max(most_z, z);
    const Vec3d level = fit.normal.cross(Vec3d::UnitZ()).normalized();  // along two of its edges
    const Vec3d steep = fit.normal.cross(level);
    Bounds edges;
    for (const Vec3f& p : cloud.points) {
      const Vec3d d = p.cast<double>();
      edges.add({d.dot(level), d.dot(steep), 0});
    }
    expect_within(edges.max.x() - edges.min.x(), 0.1, 2);
    expect_within(edges.max.y() - edges.min.y(), 0.1, 2);
  }
  EXPECT_NEAR(sum_z / 40, 0.5, 0.15);
  EXPECT_LT(least_z, 0.1);
  EXPECT_GT(most_z, 0.9);
}

TEST(TrainingSet, ObjectsAreEvenlySpread) {
  for (const planes::LabeledCloud& cloud : make_training_set(objects(1, 1, 1), 1)) {
    double nearest2 = 1e9;
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      for (std::size_t j = i + 1; j < i + 200 && j < cloud.points.size(); ++j)
        nearest2 = std::min<double>(nearest2, (cloud.points[i] - cloud.points[j]).squaredNorm());
    const Vec3d size = bounds_of(cloud).max - bounds_of(cloud).min;
    const double area = size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
    EXPECT_GT(std::sqrt(nearest2), 0.4 * std::sqrt(area / 8192)) << cloud.kind;
  }
}

TEST(TrainingSet, ScansShowBothLabelsWithinRangeOnTheirVoxels) {
  TrainingSetOptions options = objects(0, 0, 0);
  options.scans = 6;
  for (const planes::LabeledCloud& scan : make_training_set(options, 2)) {
    EXPECT_EQ(scan.kind, "scan");
    EXPECT_GE(scan.points.size(), 300u);
    const auto h = std::count(scan.labels.begin(), scan.labels.end(), Label::h);
    const auto v = std::count(scan.labels.begin(), scan.labels.end(), Label::v);
    EXPECT_GT(h, 0);
    EXPECT_GT(v, 0);
    EXPECT_EQ(h + v, std::ssize(scan.labels));
    std::set<std::tuple<int, int, int>> voxels;
    for (const Vec3f& p : scan.points) {
      EXPECT_LT(p.norm(), 2.3) << "1.5 m of depth, seen at the corner of the picture";
      const Eigen::Vector3i v3 = ((p.array() + 1.6f) / 0.02f).floor().cast<int>();
      voxels.emplace(v3.x(), v3.y(), v3.z());
    }
    EXPECT_GT(static_cast<double>(voxels.size()), 0.99 * static_cast<double>(scan.points.size()));
  }
}

TEST(TrainingSet, AnExactScanHasTheLabelsOfItsSurfaces) {
  Scene scene;
  scene.camera.position = Vec3d(0, 0, 0.8);
  scene.camera.pitch_deg = 40;
  add_polygon(scene, {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {});
  add_polygon(scene, {{1, 9, 0}, {1, -9, 0}, {1, -9, 3}, {1, 9, 3}}, {});
  D435Model model;
  model.color = model.noise = false;
  const planes::LabeledCloud scan = make_scan(scene, model, 0.02, 1);
  ASSERT_GT(scan.points.size(), 1000u);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    // The sensor is at the origin, x forward, z up.
    const double above_floor = scan.points[i].z() + 0.8, before_wall = 1 - scan.points[i].x();
    if (before_wall > 0.03) {
      EXPECT_EQ(scan.labels[i], Label::h);
    }
    if (above_floor > 0.03) {
      EXPECT_EQ(scan.labels[i], Label::v);
    }
  }
}

TEST(TrainingSet, WithRealErrorsHalfOfTheScansExtendBeyondTheCrop) {
  int far = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const planes::LabeledCloud usual = make_training_scan(seed, 0.02);
    EXPECT_TRUE(std::ranges::all_of(usual.points, [](auto& p) { return p.x() < 1.6; }));
    const planes::LabeledCloud scan = make_training_scan(seed, 0.02, true);
    const bool reaches = std::ranges::any_of(scan.points, [](auto& p) { return p.x() > 1.8; });
    far += reaches;
  }
  EXPECT_GT(far, 8);
  EXPECT_LT(far, 28);
}

TEST(TrainingRecipes, AreTheUsualOneWithRealErrorsForTheRealCamera) {
  for (const std::string& name : recipe_names())
    EXPECT_EQ(make_recipe(name).set.real_errors, name == "real-camera") << name;
  EXPECT_EQ(make_recipe("real-camera").set.scans, make_recipe("planescope").set.scans);
}

TEST(TrainingSet, ComposedScenesKeepTheCameraWithinItsRanges) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Scene scene = compose_scene(seed);
    expect_within(scene.camera.position.z(), 0.4, 1.2);
    expect_within(scene.camera.pitch_deg, 15, 60);
    expect_within(std::abs(scene.camera.roll_deg), 0, 10);
    EXPECT_GE(scene.surfaces.size(), 2u);
  }
}

TEST(TrainingSet, IsTheSameForAnyNumberOfThreads) {
  const auto one = make_training_set(one_of_each(), 1), four = make_training_set(one_of_each(), 4);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(same(one[i], four[i])) << i;
}

TEST(TrainingSet, AShapeDoesNotDependOnTheNumberOfOthers) {
  TrainingSetOptions more = one_of_each();
  more.stairs = 2;
  const auto few = make_training_set(one_of_each(), 2), many = make_training_set(more, 2);
  EXPECT_TRUE(same(few[0], many[0]));
  for (std::size_t i = 1; i < few.size(); ++i) EXPECT_TRUE(same(few[i], many[i + 1])) << i;
}

TEST(TrainingSet, AnotherSeedGivesOtherShapes) {
  TrainingSetOptions other = one_of_each();
  other.seed = 2;
  const auto a = make_training_set(one_of_each(), 2), b = make_training_set(other, 2);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_FALSE(same(a[i], b[i])) << i;
}

TEST(TrainingSet, ProgressIsReportedToTheCallerWhoCanStopIt) {
  TrainingSetOptions options = objects(0, 0, 50);
  options.points = 64;
  int last = 0;
  make_training_set(options, 3, [&](int done, int all) {
    EXPECT_GT(done, last);
    EXPECT_EQ(all, 50);
    last = done;
  });
  EXPECT_GT(last, 0);
  const auto stop = [](int, int) { throw std::runtime_error("stop"); };
  EXPECT_THROW(make_training_set(options, 3, stop), std::runtime_error);
}

TEST(TestScans, AlternateTheNamedScenesForAnyNumberOfThreads) {
  const auto scans = make_test_scans(1, 6, 0.02, 2), again = make_test_scans(1, 6, 0.02, 1);
  ASSERT_EQ(scans.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(same(scans[i], again[i]));
    EXPECT_GT(scans[i].points.size(), 2000u);
  }
  EXPECT_FALSE(same(scans[0], scans[5])) << "the same scene, another seed";
}

TEST(TestScans, ShowOtherScenesThanTrainingWithTheSameSeed) {
  TrainingSetOptions options;
  options.seed = 5;
  options.stairs = options.boxes = options.planes = 0;
  options.scans = 1;
  const planes::LabeledCloud trained = make_training_set(options, 1)[0];
  EXPECT_NE(make_composed_test_scan(5, 0).points.size(), trained.points.size());
  EXPECT_NE(make_test_scan(5, 0).points.size(), trained.points.size());
}

// ---- Augmentation ----

/// A level square of 1 m with 64 x 64 points, labeled like a chessboard so that neighbors have
/// different labels.
planes::LabeledCloud board() {
  planes::LabeledCloud cloud{"board", {}, {}};
  for (int i = 0; i < 4096; ++i) {
    const int x = i % 64, y = i / 64;
    cloud.points.emplace_back(static_cast<float>(x) / 63, static_cast<float>(y) / 63, 0.5f);
    cloud.labels.push_back((x + y) % 2 == 0 ? Label::h : Label::v);
  }
  return cloud;
}

AugmentOptions nothing() {
  AugmentOptions options;
  options.uniform_noise_m = 0;
  options.clusters = 0;
  options.points = 0;
  options.yaw_deg = 0;
  return options;
}

TEST(Augment, WithoutOptionsTheCloudDoesNotChange) {
  const planes::LabeledCloud cloud = board(), same = augment(cloud, nothing(), 3);
  EXPECT_EQ(same.kind, cloud.kind);
  EXPECT_EQ(same.points, cloud.points);
  EXPECT_EQ(same.labels, cloud.labels);
}

TEST(Augment, TheSeedDeterminesTheCloud) {
  AugmentOptions options;
  options.gaussian_noise_m = 0.003;
  options.tilt_deg = 3;
  options.thinning = 0.5;
  const planes::LabeledCloud a = augment(board(), options, 1), b = augment(board(), options, 1);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_NE(a.points, augment(board(), options, 2).points);
}

TEST(Augment, UniformNoiseReachesBothBoundsAndNoFarther) {
  AugmentOptions options = nothing();
  options.uniform_noise_m = 0.01;
  const planes::LabeledCloud cloud = board(), noisy = augment(cloud, options, 1);
  EXPECT_EQ(noisy.labels, cloud.labels);
  Vec3f least = Vec3f::Zero(), most = Vec3f::Zero();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    least = least.cwiseMin(noisy.points[i] - cloud.points[i]);
    most = most.cwiseMax(noisy.points[i] - cloud.points[i]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(least[axis], -0.01, 1e-4);
    EXPECT_NEAR(most[axis], 0.01, 1e-4);
  }
}

TEST(Augment, GaussianNoiseVariesAmongCloudsUpToItsDeviation) {
  AugmentOptions options = nothing();
  options.gaussian_noise_m = 0.003;
  double least = 1, most = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    double squares = 0;
    const planes::LabeledCloud noisy = augment(board(), options, seed);
    for (const Vec3f& p : noisy.points) squares += std::pow(p.z() - 0.5, 2);
    const double deviation = std::sqrt(squares / 4096);
    least = std::min(least, deviation);
    most = std::max(most, deviation);
  }
  EXPECT_LT(least, 0.0006);
  EXPECT_GT(most, 0.0024);
  EXPECT_LT(most, 0.0031);
}

TEST(Augment, YawTurnsAboutTheVerticalOnly) {
  AugmentOptions options = nothing();
  options.yaw_deg = 180;
  const planes::LabeledCloud cloud = board(), turned = augment(cloud, options, 5);
  double moved = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_EQ(turned.points[i].z(), 0.5f);
    EXPECT_NEAR(turned.points[i].norm(), cloud.points[i].norm(), 1e-5);
    moved = std::max<double>(moved, (turned.points[i] - cloud.points[i]).norm());
  }
  EXPECT_GT(moved, 0.1);
}

TEST(Augment, TiltStaysWithinItsAngleAndKeepsTheLabels) {
  AugmentOptions options = nothing();
  options.tilt_deg = 5;
  double most = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const planes::LabeledCloud cloud = board(), tilted = augment(cloud, options, seed);
    EXPECT_EQ(tilted.labels, cloud.labels);
    const Vec3f u = tilted.points[63] - tilted.points[0];
    const Vec3f v = tilted.points[63 * 64] - tilted.points[0];
    const double angle = std::acos(std::min(1.f, u.cross(v).normalized().z())) * 180 / M_PI;
    most = std::max(most, angle);
  }
  EXPECT_GT(most, 3);
  EXPECT_LT(most, 5.01);
}

TEST(Augment, ClustersAreRoundHolesThatLeaveHalfOfThePoints) {
  AugmentOptions options = nothing();
  options.clusters = 4;
  options.cluster_radius_m = 0.3;
  bool whole = false, holed = false;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const planes::LabeledCloud rest = augment(board(), options, seed);
    EXPECT_GE(rest.points.size(), 2048u);
    EXPECT_EQ(rest.points.size(), rest.labels.size());
    whole = whole || rest.points.size() == 4096;
    holed = holed || rest.points.size() < 3600;
  }
  EXPECT_TRUE(whole && holed);
  options.cluster_radius_m = 100;
  EXPECT_GE(augment(board(), options, 1).points.size(), 2048u);
}

TEST(Augment, KeepsTheNearestNeighborsOfAPointWithTheirLabels) {
  AugmentOptions options = nothing();
  options.points = 500;
  const planes::LabeledCloud cloud = board();
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const planes::LabeledCloud part = augment(cloud, options, seed);
    ASSERT_EQ(part.points.size(), 500u);
    for (std::size_t i = 0; i < 500; ++i) {
      const long x = std::lround(part.points[i].x() * 63), y = std::lround(part.points[i].y() * 63);
      EXPECT_EQ(part.labels[i], cloud.labels[static_cast<std::size_t>(y * 64 + x)]);
    }
    // 500 of 4096 points of a square meter: a disc of 0.2 m radius, or a quarter of a disc of 0.4 m
    // in a corner.
    Vec3f least = part.points[0], most = part.points[0];
    for (const Vec3f& p : part.points) {
      least = least.cwiseMin(p);
      most = most.cwiseMax(p);
    }
    EXPECT_LT((most - least).maxCoeff(), 0.6);
  }
}

TEST(Augment, ThinningKeepsARandomShare) {
  AugmentOptions options = nothing();
  options.thinning = 0.25;
  std::size_t least = 4096, most = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::size_t count = augment(board(), options, seed).points.size();
    least = std::min(least, count);
    most = std::max(most, count);
  }
  EXPECT_NEAR(static_cast<double>(least), 0.3 * 4096, 400);
  EXPECT_NEAR(static_cast<double>(most), 0.95 * 4096, 400);
}

TEST(Augment, AnEmptyCloudStaysEmpty) {
  const planes::LabeledCloud none{"none", {}, {}};
  EXPECT_TRUE(augment(none, AugmentOptions{}, 1).points.empty());
}

}  // namespace
}  // namespace planescope::lab
