// Of all that can be set.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/planes/pipeline/options_table.hpp"
#include "support/gap_scenes.hpp"
#include "support/scenes.hpp"
#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

const Vec3d kSensor(-1.5, 0, 0.8);

struct Setting {
  SegmentOptions options;
  bool picture = false;  // the points come from a depth image
  bool gaps = false;     // other clouds, with gaps that a sensor looks through or not
};

/// Profiles, and what must be otherwise for an option to matter.
std::vector<Setting> settings() {
  std::vector<Setting> all{{profile_options(Profile::refined)},
                           {profile_options(Profile::refined), false, true},
                           {profile_options(Profile::paper_closest)}};
  SegmentOptions options = profile_options(Profile::refined);
  options.r8_voxel_spread.on = true;
  all.push_back({options});
  options = profile_options(Profile::refined);
  options.r10_minor.pixels = 5;  // of few
  all.push_back({options, true});
  options.use_labels = options.noise.estimate_sigma = false;  // planes across edges
  options.noise.fixed_rms_m = 0.05;
  all.push_back({options, true});
  options = profile_options(Profile::refined);
  options.noise.estimate_sigma = options.noise.sigma_by_range = false;
  options.split_disconnected.rule = SplitRule::on;
  all.push_back({options});
  PipelineOptions every;  // refinement there is
  for (const OptionInfo& info : option_table())
    if (info.section == "refinements" && info.kind == OptionKind::on_off) info.set(every, "on");
  all.push_back({every.segment});
  return all;
}

std::vector<std::int32_t> planes_of(const test::LabelledCloud& cloud,
                                    const SegmentOptions& options,
                                    bool picture = false) {
  Measurements more;
  if (picture) more.pixels = test::picture_of(cloud.points, kSensor);
  if (options.r8_voxel_spread.on)
    more.spreads.assign(cloud.points.size(), {.xx = 2e-5f, .yy = 1e-5f, .zz = 1e-5f});
  return segment(cloud.points, cloud.labels, cloud.cube, kSensor, options, nullptr, more).plane_of;
}

class Clouds {
 public:
  /// Does the number change anything on some cloud in some setting?
  bool feel(const OptionInfo& info) {
    if (info.section == "objective") return feel_on_pixels(info) || feel_by_objective(info);
    for (const double factor : {2.0, 0.5, 10.0, 0.1, 1000.0, 0.0})
      for (std::size_t s = 0; s < settings_.size(); ++s)
        for (std::uint64_t seed = 1; seed <= kClouds; ++seed) {
          PipelineOptions options;
          options.segment = settings_[s].options;
          const std::string before = info.get(options);
          const double value = factor * number_of(info, options);
          info.set(options, number_text(info, value == 0 && factor > 0 ? 0.02 * factor : value));
          if (info.get(options) == before) continue;
          if (planes_in(settings_[s], options.segment, seed) != as_it_is(s, seed)) return true;
        }
    return false;
  }

 private:
  static constexpr std::uint64_t kClouds = 40;

  static PipelineOptions changed(const OptionInfo& info, double factor) {
    PipelineOptions options = test::wall_options();
    options.segment.objective.on = true;
    info.set(options, number_text(info, factor * number_of(info, options)));
    return options;
  }
  /// On a depth image: a post before a wall, curved at one side, and a floor.
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
    static const std::vector<std::int32_t> as_it_is = planes_of(changed(info, 1));
    for (const double factor : {2.0, 0.5, 10.0, 0.1, 1000.0, 0.0})
      if (planes_of(changed(info, factor)) != as_it_is) return true;
    return false;
  }
  bool feel_by_objective(const OptionInfo& info) {
    for (const double factor : {2.0, 0.5, 10.0, 0.1, 1000.0, 0.0})
      for (std::uint64_t seed = 1; seed <= kClouds; ++seed)
        if (planes_of(cloud(seed), changed(info, factor).segment) !=
            planes_of(cloud(seed), changed(info, 1).segment))
          return true;
    return false;
  }
  std::vector<std::int32_t> planes_in(const Setting& setting,
                                      const SegmentOptions& options,
                                      std::uint64_t seed) {
    if (!setting.gaps) return planes_of(cloud(seed), options, setting.picture);
    const test::CloudWithGaps scene = test::cloud_with_gaps(seed);
    return segment(scene.cloud.points, scene.cloud.labels, scene.cloud.cube, scene.sensor, options,
                   nullptr, scene.more)
        .plane_of;
  }
  const test::LabelledCloud& cloud(std::uint64_t seed) {
    while (clouds_.size() < seed) {
      const std::uint64_t next = clouds_.size() + 1;
      clouds_.push_back(next % 2 == 0 ? test::random_cloud(next) : test::random_steps(next));
    }
    return clouds_[seed - 1];
  }
  const std::vector<std::int32_t>& as_it_is(std::size_t setting, std::uint64_t seed) {
    std::vector<std::int32_t>& known = known_[{setting, seed}];
    if (known.empty()) known = planes_in(settings_[setting], settings_[setting].options, seed);
    return known;
  }

  const std::vector<Setting> settings_ = settings();
  std::vector<test::LabelledCloud> clouds_;
  std::map<std::pair<std::size_t, std::uint64_t>, std::vector<std::int32_t>> known_;
};

TEST(Options, EveryNumberOfTheMethodSteersIt) {
  Clouds clouds;
  int numbers = 0;
  for (const OptionInfo& info : option_table()) {
    if (!info.is_number() || !info.steers_segmentation()) continue;
    EXPECT_TRUE(clouds.feel(info)) << info.name;
    ++numbers;
  }
  EXPECT_GE(numbers, 45);
}

TEST(Options, MeanNothingWhileTheirSwitchIsOff) {
  PipelineOptions options;
  options.segment = profile_options(Profile::refined);
  const OptionInfo& share = find_option("r2_unexplained_share");
  const OptionInfo& sigmas = find_option("tau_sigmas");
  EXPECT_FALSE(is_idle(share, options) || is_idle(sigmas, options));
  options.segment = profile_options(Profile::paper);
  EXPECT_TRUE(is_idle(share, options) && is_idle(sigmas, options));
  EXPECT_FALSE(is_idle(find_option("theta_n_in"), options));
  for (const OptionInfo& info : option_table())
    if (is_idle(info, options)) {
      PipelineOptions other = options;
      info.set(other, number_text(info, 2 * number_of(info, options)));
      const test::LabelledCloud cloud = test::random_steps(3);
      EXPECT_EQ(planes_of(cloud, other.segment), planes_of(cloud, options.segment)) << info.name;
    }
}

TEST(Options, OfARefinementStandInAGroup) {
  for (const OptionInfo& info : option_table())
    EXPECT_EQ(info.section == "refinements", !info.group.empty()) << info.name;
}

}  // namespace
}  // namespace planescope::planes
