// Tests that every option has an effect.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/planes/pipeline/options_table.hpp"
#include "support/scenes.hpp"
#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

const Vec3d kEye(-1.5, 0, 0.8);

std::vector<std::int32_t> planes_of(const test::LabeledCloud& cloud,
                                    const SegmentOptions& options) {
  return segment(cloud.points, cloud.labels, cloud.cube, kEye, options).plane_of;
}

constexpr double kFactors[] = {2, 0.5, 10, 0.1, 1000, 0};

class Clouds {
 public:
  /// Whether the number changes the result of some cloud with some settings.
  bool feel(const OptionInfo& info) {
    const bool refined = info.objective.value_or(true), paper = !info.objective.value_or(false);
    return (refined && (feel_on_clouds(info, Profile::refined) || feel_on_pixels(info))) ||
           (paper && feel_on_clouds(info, Profile::paper_closest));
  }

 private:
  static constexpr std::uint64_t kClouds = 40;

  static PipelineOptions changed(const OptionInfo& info, Profile profile, double factor) {
    PipelineOptions options = test::wall_options();
    options.segment = profile_options(profile);
    const double value = factor * number_of(info, options);
    info.set(options, number_text(info, value == 0 && factor > 0 ? 0.02 * factor : value));
    return options;
  }
  /// The same for a depth image: a post in front of a wall that is curved on one side, and a floor.
  bool feel_on_pixels(const OptionInfo& info) {
    static const Frame frame = test::depth_frame([](double x, double y) {
      if (std::abs(x + 0.2) < 0.02) return 0.9;
      const double wall = 1.5 + 0.1 * std::max(0.0, x) + 0.5 * x * std::max(0.0, x - 0.3);
      return std::min(wall, y > 0.1 ? 0.5 / y : wall);
    });
    const auto planes_of = [](const PipelineOptions& options) {
      const FrameResult result = run_frame(frame, options, nullptr);
      std::vector<std::int32_t> planes = result.plane_of;
      for (const PlaneRegion& plane : result.segmentation.planes) planes.push_back(plane.undecided);
      return planes;
    };
    static const std::vector<std::int32_t> as_it_is = planes_of(changed(info, Profile::refined, 1));
    for (const double factor : kFactors)
      if (planes_of(changed(info, Profile::refined, factor)) != as_it_is) return true;
    return false;
  }
  bool feel_on_clouds(const OptionInfo& info, Profile profile) {
    for (const double factor : kFactors)
      for (std::uint64_t seed = 1; seed <= kClouds; ++seed)
        if (planes_of(cloud(seed), changed(info, profile, factor).segment) !=
            planes_of(cloud(seed), changed(info, profile, 1).segment))
          return true;
    return false;
  }
  const test::LabeledCloud& cloud(std::uint64_t seed) {
    while (clouds_.size() < seed) {
      const std::uint64_t next = clouds_.size() + 1;
      clouds_.push_back(next % 2 == 0 ? test::random_cloud(next) : test::random_steps(next));
    }
    return clouds_[seed - 1];
  }
  std::vector<test::LabeledCloud> clouds_;
};

TEST(Options, EveryNumberAffectsItsMethod) {
  Clouds clouds;
  int numbers = 0;
  for (const OptionInfo& info : option_table()) {
    if (!info.is_number() || !info.steers_segmentation()) continue;
    EXPECT_TRUE(clouds.feel(info)) << info.name;
    ++numbers;
  }
  EXPECT_GE(numbers, 20);
}

TEST(Options, OfTheOtherMethodHaveNoEffect) {
  for (const Profile profile : {Profile::paper, Profile::refined}) {
    PipelineOptions options;
    options.segment = profile_options(profile);
    int idle = 0;
    for (const OptionInfo& info : option_table()) {
      if (!is_idle(info, options) || !info.is_number()) continue;
      PipelineOptions other = options;
      info.set(other, number_text(info, 2 * number_of(info, options)));
      const test::LabeledCloud cloud = test::random_steps(3);
      EXPECT_EQ(planes_of(cloud, other.segment), planes_of(cloud, options.segment)) << info.name;
      ++idle;
    }
    EXPECT_GE(idle, 4);
    EXPECT_FALSE(is_idle(find_option("theta_n_in"), options));
  }
}

}  // namespace
}  // namespace planescope::planes
