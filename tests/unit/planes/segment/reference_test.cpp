// Test that the method finds the same planes as the reference implementation.

#include <gtest/gtest.h>

#include "support/reference_segment.hpp"
#include "support/scenes.hpp"

namespace planescope::planes {
namespace {

/// Expects the same points in the same planes, up to numbering, with the same parameters.
void expect_same(const Segmentation& ours,
                 const reference::Result& plain,
                 const std::string& what) {
  ASSERT_EQ(ours.planes.size(), plain.planes.size()) << what;
  std::vector<int> number(plain.planes.size(), 0);
  for (std::size_t i = 0; i < ours.plane_of.size(); ++i) {
    ASSERT_EQ(ours.plane_of[i] == 0, plain.plane_of[i] < 0) << what << ", point " << i;
    if (plain.plane_of[i] < 0) continue;
    int& known = number[plain.plane_of[i]];
    if (known == 0) known = ours.plane_of[i];
    ASSERT_EQ(known, ours.plane_of[i]) << what << ", point " << i;
  }
  for (std::size_t k = 0; k < plain.planes.size(); ++k) {
    const PlaneRegion& a = ours.planes[number[k] - 1];
    if (k > 0) {
      EXPECT_GT(a.founded, ours.planes[number[k - 1] - 1].founded) << what;
    }
    const reference::Plane& b = plain.planes[k];
    EXPECT_EQ(a.label, b.label) << what;
    EXPECT_LT((a.fit.centroid - b.fit.centroid).norm(), 1e-9) << what;
    const double sign = a.fit.normal.dot(b.fit.normal) < 0 ? -1 : 1;
    EXPECT_LT((a.fit.normal - sign * b.fit.normal).norm(), 1e-9) << what;
    EXPECT_NEAR(a.fit.eigenvalues[0], b.fit.eigenvalues[0], 1e-9) << what;
  }
}

class AgainstReference : public testing::TestWithParam<Profile> {};

TEST_P(AgainstReference, RandomCloudsGiveIdenticalPlanes) {
  std::size_t planes = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const auto [points, labels, cube] =
        seed % 4 == 0 ? test::random_steps(seed) : test::random_cloud(seed);
    SegmentOptions options = profile_options(GetParam());
    options.use_labels = seed % 5 != 0;
    options.mse_normalization = seed % 7 == 0 ? MseNormalization::mean : MseNormalization::scatter;
    if (options.mse_normalization == MseNormalization::mean) options.theta_e_n_m2 = 4e-5;
    options.merge_partner = seed % 3 == 0 ? MergePartner::best : MergePartner::first;
    const reference::Result plain = reference::segment(points, labels, cube, options);
    expect_same(segment(points, labels, cube, Vec3d(-1.5, 0, 0.8), options), plain,
                "seed " + std::to_string(seed));
    if (HasFatalFailure()) return;
    planes += plain.planes.size();
  }
  EXPECT_GT(planes, 600u);  // the clouds contain enough structure
}

INSTANTIATE_TEST_SUITE_P(Profiles,
                         AgainstReference,
                         testing::Values(Profile::paper, Profile::paper_closest),
                         [](const auto& p) {
                           std::string name = to_string(p.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace planescope::planes
