// Tests of the paper's criteria 1, 3 and 4, and of profiles.

#include "core/planes/segment/criteria.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::planes {
namespace {

OctreeNode node_with(std::uint32_t n_h, std::uint32_t n_v) {
  OctreeNode node;
  node.end = n_h + n_v;
  node.count_h = n_h;
  return node;
}

PlaneFit plane_at(const Vec3d& centroid, const Vec3d& normal) {
  PlaneFit fit;
  fit.count = 10;
  fit.centroid = centroid;
  fit.normal = normal.normalized();
  return fit;
}

TEST(Criterion1, NeedsBothFewAndRelativelyFewOutliers) {
  const SegmentOptions options = profile_options(Profile::paper);
  EXPECT_TRUE(is_pure(purity_of(node_with(95, 5), true), options));    // 5 outliers, 5 %
  EXPECT_FALSE(is_pure(purity_of(node_with(94, 5), true), options));   // 5 outliers, over 5 %
  EXPECT_FALSE(is_pure(purity_of(node_with(194, 6), true), options));  // 3 %, but 6 outliers
  EXPECT_TRUE(is_pure(purity_of(node_with(0, 7), true), options));
}

TEST(Criterion1, InliersAreTheMajorityLabel) {
  EXPECT_EQ(purity_of(node_with(3, 8), true).inlier, Label::v);
  EXPECT_EQ(purity_of(node_with(3, 8), true).n_out, 3u);
  EXPECT_EQ(purity_of(node_with(4, 4), true).inlier, Label::h);
}

TEST(Criterion3, IsTheScatterAsPrintedOrItsMean) {
  PlaneFit fit;
  fit.count = 100;
  fit.eigenvalues = {0.004, 1, 1};
  EXPECT_TRUE(is_planar(fit, 0.005, MseNormalization::scatter));
  EXPECT_FALSE(is_planar(fit, 0.003, MseNormalization::scatter));
  EXPECT_TRUE(is_planar(fit, 0.00005, MseNormalization::mean));
  EXPECT_FALSE(is_planar(fit, 0.00003, MseNormalization::mean));
}

TEST(Criterion4, ComparesDirectionsSoThatAFarStepPasses) {
  // A kerb 12 cm high, with centroids 1 m apart: 0.12 / 1.007 = 0.119 <= 0.15. The paper's
  // criterion merges it with the floor; the offset of paper-closest does not.
  const auto terms = coplanarity(plane_at({0, 0, 0}, {0, 0, 1}), plane_at({1, 0, 0.12}, {0, 0, 1}));
  EXPECT_NEAR(terms.n1_dmu, 0.12 / std::sqrt(1 + 0.12 * 0.12), 1e-12);
  EXPECT_TRUE(is_coplanar(terms, profile_options(Profile::paper)));
  EXPECT_FALSE(is_coplanar(terms, profile_options(Profile::paper_closest)));
}

TEST(Criterion4, ItsThirdLineTestsTheCandidatesNormal) {
  // The candidate's normal is 10 degrees off: |n2 . dmu| / |dmu| = sin 10 = 0.174 > 0.15.
  const double a = 10 * M_PI / 180;
  const auto terms = coplanarity(plane_at({0, 0, 0}, {0, 0, 1}),
                                 plane_at({1, 0, 0}, {std::sin(a), 0, std::cos(a)}));
  SegmentOptions options = profile_options(Profile::paper);
  EXPECT_FALSE(is_coplanar(terms, options));
  options.criterion4_n2 = false;
  EXPECT_TRUE(is_coplanar(terms, options));
}

TEST(Profiles, HaveNamesAndUnknownNamesAreRejected) {
  for (const Profile p : {Profile::paper, Profile::paper_closest, Profile::refined}) {
    EXPECT_EQ(parse_profile(to_string(p)), p);
    EXPECT_EQ(profile_options(p).profile, p);
  }
  EXPECT_THROW(parse_profile("papers"), Error);
}

TEST(Profiles, PaperHasThePapersParameters) {
  const SegmentOptions o = profile_options(Profile::paper);
  EXPECT_EQ(o.theta_n_out, 5);
  EXPECT_EQ(o.theta_r_out, 0.05);
  EXPECT_EQ(o.theta_n_in, 5);
  EXPECT_EQ(o.theta_e_n_m2, 0.005);
  EXPECT_EQ(o.theta_coplane, 0.85);
  EXPECT_EQ(o.leftover_distance_m, 0.005);
}

}  // namespace
}  // namespace planescope::planes
