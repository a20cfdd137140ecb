// Tests of detecting stairs, landings, kerbs, ramps and the floor.

#include "core/planes/stairs/stairs.hpp"

#include <gtest/gtest.h>

#include "unit/planes/stairs/ideal_planes.hpp"

namespace planescope::planes {
namespace {

using test::flight_up;
using test::IdealPlanes;

std::string reported(const Stairs& stairs) {
  std::string text;
  for (const StepDecision& decision : stairs.decisions) text += to_text(decision) + "\n";
  return text;
}

TEST(Stairs, AFlightHasItsStepsRiseAndGoingInAnyDirection) {
  for (const double deg : {0.0, 31.0, 90.0, 200.0}) {
    IdealPlanes ideal = flight_up(5);
    ideal.turn(deg);
    const Stairs stairs = ideal.find();
    ASSERT_EQ(stairs.flights.size(), 1u) << deg;
    const Flight& flight = stairs.flights[0];
    ASSERT_EQ(flight.steps.size(), 5u) << deg;
    EXPECT_NEAR(flight.rise_m, 0.17, 1e-6);
    EXPECT_NEAR(flight.going_m, 0.28, 0.002);
    EXPECT_NEAR(flight.width_m, 1, 0.05);
    EXPECT_NEAR(std::atan2(flight.uphill.y(), flight.uphill.x()),
                std::remainder(deg, 360) * std::numbers::pi / 180, 0.01);
    EXPECT_EQ(flight.foot, LevelPlanes{1});
    EXPECT_EQ(flight.seen, SeenFrom::below);
    EXPECT_FALSE(flight.landing);
    for (int i = 0; i < 5; ++i) {
      const Flight::Step& step = flight.steps[i];
      EXPECT_EQ(step.tread, LevelPlanes{3 + 2 * i});
      EXPECT_EQ(step.riser, 2 + 2 * i);
      EXPECT_NEAR(step.rise_m, 0.17, 1e-6);
      EXPECT_NEAR(step.going_m, i == 0 ? 0 : 0.28, 0.002);
      EXPECT_NEAR(step.nosing.left.z(), 0.17 * (i + 1), 1e-6);
    }
    EXPECT_TRUE(stairs.kerbs.empty());
    EXPECT_TRUE(stairs.ramps.empty());
  }
}

TEST(Stairs, SeenFromTheTopLeadDownEvenIfTreadsHideEachOther) {
  // Each level hides the next one below its nosing, along the line of sight over the nosing.
  constexpr double kRise = 0.17, kGoing = 0.28;
  const Vec3d sensor(1.2, 0, 4 * kRise + 0.8);
  IdealPlanes ideal;
  ideal.sensor = sensor;
  for (int i = 0; i <= 4; ++i) {  // nosings of levels 1 to 4 at 0, 0.28, ...
    const double z = i * kRise, nosing = (i - 1) * kGoing, next = i * kGoing;
    const double hidden = (sensor.x() - next) * kRise / (sensor.z() - z - kRise);
    ideal.level(i == 0 ? -0.8 : nosing, i == 4 ? 1.6 : next - hidden, -0.5, 0.5, z);
  }
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.flights.size(), 1u) << reported(stairs);
  const Flight& flight = stairs.flights[0];
  ASSERT_EQ(flight.steps.size(), 4u);
  EXPECT_EQ(flight.seen, SeenFrom::above);
  EXPECT_NEAR(flight.rise_m, kRise, 1e-6);
  EXPECT_NEAR(flight.going_m, kGoing, 0.002);
  EXPECT_TRUE(flight.landing);
  EXPECT_NEAR(stairs.height_m[4], 4 * kRise, 1e-6) << "above the floor, where the flight ends";

  ideal.sensor.reset();
  EXPECT_TRUE(ideal.find().flights.empty()) << "nobody knows that the gaps are hidden";
}

TEST(Stairs, OfACloudHaveNoDirection) {
  IdealPlanes ideal = flight_up(3);
  ideal.sensor.reset();
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.flights.size(), 1u);
  EXPECT_EQ(stairs.flights[0].seen, SeenFrom::unknown);
}

TEST(Stairs, ADeepLastTreadIsALanding) {
  IdealPlanes ideal = flight_up(3);
  ideal.riser(0.84, -0.5, 0.5, 0.51, 0.68);
  ideal.level(0.84, 2, -0.5, 0.5, 0.68);
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.flights.size(), 1u);
  EXPECT_EQ(stairs.flights[0].steps.size(), 4u);
  EXPECT_TRUE(stairs.flights[0].landing);
}

TEST(Stairs, TwoTablesOfDifferentHeightAreNotStairs) {
  IdealPlanes ideal;
  ideal.level(-1, 1.5, -1, 1, 0);
  const int low = ideal.level(0, 0.6, -0.6, 0.6, 0.55);
  const int high = ideal.level(0.9, 1.5, -0.6, 0.6, 0.75);
  const Stairs stairs = ideal.find();
  EXPECT_TRUE(stairs.flights.empty());
  EXPECT_TRUE(stairs.kerbs.empty());
  EXPECT_NEAR(stairs.height_m[low - 1], 0.55, 1e-9);
  EXPECT_NEAR(stairs.height_m[high - 1], 0.75, 1e-9);
  EXPECT_EQ(reported(stairs),
            "P1 -> P2 no step: rise 55 cm, limit 30 cm\n"
            "P1 -> P3 no step: rise 75 cm, limit 30 cm\n");
}

TEST(Stairs, AFlightContinuesOverOneUnseenTread) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -0.6, 0.6, 0);
  for (const int i : {0, 1, 3, 4}) ideal.level(i * 0.28, (i + 1) * 0.28, -0.5, 0.5, (i + 1) * 0.15);
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.flights.size(), 1u) << reported(stairs);
  const Flight& flight = stairs.flights[0];
  ASSERT_EQ(flight.steps.size(), 5u);
  EXPECT_TRUE(flight.steps[2].tread.empty());
  EXPECT_NEAR(flight.steps[2].nosing.left.x(), 0.56, 0.002);
  EXPECT_NEAR(flight.rise_m, 0.15, 1e-6);
  EXPECT_NEAR(flight.going_m, 0.28, 0.002);
}

TEST(Stairs, AMinorPlaneCanOnlyBeALastTread) {
  IdealPlanes minor;
  minor.level(0.56, 0.84, -0.5, 0.5, 0.51);
  minor.level(0.84, 1.12, -0.5, 0.5, 0.68);  // a tread behind a minor one is ignored
  const Stairs stairs = flight_up(2).find(minor.covering());
  ASSERT_EQ(stairs.flights.size(), 1u);
  ASSERT_EQ(stairs.flights[0].steps.size(), 3u);
  EXPECT_EQ(stairs.flights[0].steps.back().tread, LevelPlanes{-1});

  IdealPlanes pavement;
  pavement.level(0, 1, -1, 1, 0.12);
  IdealPlanes road;
  road.level(-1, 0, -1, 1, 0);
  EXPECT_TRUE(road.find(pavement.covering()).kerbs.empty());
}

TEST(Stairs, AMinorPlaneCanBeTheFoot) {
  IdealPlanes minor, ideal;
  minor.level(-0.28, 0, -0.5, 0.5, 0);
  ideal.level(0, 0.28, -0.5, 0.5, 0.17);
  ideal.level(0.28, 0.56, -0.5, 0.5, 0.34);
  const Stairs stairs = ideal.find(minor.covering());
  ASSERT_EQ(stairs.flights.size(), 1u);
  EXPECT_EQ(stairs.flights[0].steps.size(), 2u);
  EXPECT_EQ(stairs.flights[0].foot, LevelPlanes{-1});
  EXPECT_EQ(stairs.floor, 1) << "a minor plane is no floor";
}

TEST(Stairs, AFlightThatTurnsAtALandingIsTwo) {
  IdealPlanes ideal = flight_up(3);
  ideal.level(0.84, 1.84, -0.5, 0.5, 0.68);  // the landing, from which steps go up to the left
  for (int i = 0; i < 3; ++i) {
    const double y = 0.5 + i * 0.28;
    ideal.level(0.84, 1.84, y, y + 0.28, 0.68 + (i + 1) * 0.17);
  }
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.flights.size(), 2u) << reported(stairs);
  EXPECT_EQ(stairs.flights[0].steps.size(), 4u);
  EXPECT_EQ(stairs.flights[1].steps.size(), 3u);
  EXPECT_NEAR(stairs.flights[1].uphill.y(), 1, 0.01);
  EXPECT_EQ(stairs.flights[1].foot, stairs.flights[0].steps.back().tread);
}

TEST(Stairs, OfASpiralAreNotAFlight) {
  IdealPlanes ideal;
  ideal.level(-2, 2, -2, 0, 0);
  for (int i = 0; i < 6; ++i) {
    const auto at = [&](double step, double r) {
      const double angle = step * 28 * std::numbers::pi / 180;
      return Vec3d(r * std::cos(angle), r * std::sin(angle), (i + 1) * 0.17);
    };
    ideal.add({at(i, 0.1), at(i, 0.9), at(i + 1, 0.9), at(i + 1, 0.1)});
  }
  EXPECT_TRUE(ideal.find().flights.empty());
}

TEST(Stairs, OneWideStepBetweenLargeLevelsIsAKerb) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -1, 1, 0);
  const int riser = ideal.riser(0, -1, 1, 0, 0.12);
  ideal.level(0, 1, -1, 1, 0.12);
  ideal.turn(20);
  const Stairs stairs = ideal.find();
  EXPECT_TRUE(stairs.flights.empty());
  ASSERT_EQ(stairs.kerbs.size(), 1u) << reported(stairs);
  EXPECT_NEAR(stairs.kerbs[0].rise_m, 0.12, 1e-6);
  EXPECT_EQ(stairs.kerbs[0].lower, LevelPlanes{1});
  EXPECT_EQ(stairs.kerbs[0].upper, LevelPlanes{3});
  EXPECT_EQ(stairs.kerbs[0].riser, riser);
  EXPECT_NEAR(stairs.kerbs[0].nosing.width_m(), 2, 0.05);
  EXPECT_TRUE(stairs.decisions.empty()) << reported(stairs);
}

TEST(Stairs, ABoxIsNotAKerb) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -1, 1, 0);
  ideal.level(0, 0.4, -0.2, 0.2, 0.15);
  const Stairs stairs = ideal.find();
  EXPECT_TRUE(stairs.kerbs.empty());
  EXPECT_EQ(reported(stairs), "P1 -> P2 single step: 40 cm wide, limit for a kerb 60 cm\n");
}

TEST(Stairs, ARampLeadsFromLevelToLevel) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -0.5, 0.5, 0);
  const int ramp = ideal.add({{0, -0.5, 0}, {1, -0.5, 0.2}, {1, 0.5, 0.2}, {0, 0.5, 0}});
  ideal.level(1, 2, -0.5, 0.5, 0.2);
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.ramps.size(), 1u);
  EXPECT_EQ(stairs.ramps[0].plane, ramp);
  EXPECT_NEAR(stairs.ramps[0].slope_deg, 11.31, 0.01);
  EXPECT_NEAR(stairs.ramps[0].rise_m, 0.2, 1e-6);
  EXPECT_EQ(stairs.ramps[0].lower, LevelPlanes{1});
  EXPECT_EQ(stairs.ramps[0].upper, LevelPlanes{3});
  EXPECT_TRUE(std::isnan(stairs.height_m[ramp - 1]));
  EXPECT_TRUE(stairs.kerbs.empty());
}

TEST(Stairs, TheFloorIsTheLowestLargeLevel) {
  IdealPlanes ideal;
  const int scrap = ideal.level(-0.1, 0.1, 0.8, 1, -0.2);  // a reflection
  const int floor = ideal.level(-1, 0, -0.6, 0.6, 0);
  ideal.level(0.5, 2.5, -1, 1, 0.4);  // larger, but higher
  const Stairs stairs = ideal.find();
  EXPECT_EQ(stairs.floor, floor);
  EXPECT_NEAR(stairs.height_m[scrap - 1], -0.2, 1e-9);
}

TEST(Stairs, PiecesOfOneTreadCountOnce) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -0.6, 0.6, 0);
  const int left = ideal.level(0, 0.28, 0.05, 0.5, 0.17);
  const int right = ideal.level(0, 0.28, -0.5, 0, 0.175);
  ideal.level(0.28, 0.56, -0.5, 0.5, 0.34);
  const Stairs stairs = ideal.find();
  ASSERT_EQ(stairs.flights.size(), 1u);
  ASSERT_EQ(stairs.flights[0].steps.size(), 2u);
  EXPECT_EQ(stairs.flights[0].steps[0].tread, (LevelPlanes{right, left}));
}

TEST(Stairs, UnevenStepsAreNotAFlightAndTheReasonIsReported) {
  IdealPlanes ideal;
  ideal.level(-1, 0, -0.6, 0.6, 0);
  ideal.level(0, 0.3, -0.5, 0.5, 0.1);
  ideal.level(0.3, 0.6, -0.5, 0.5, 0.35);
  const Stairs stairs = ideal.find();
  EXPECT_TRUE(stairs.flights.empty());
  EXPECT_NE(reported(stairs).find(
                "P2 -> P3 not part of the flight below: rises differ by 15 cm, limit 3 cm"),
            std::string::npos)
      << reported(stairs);
}

TEST(Stairs, WithoutGravityNothingIsLevel) {
  IdealPlanes ideal = flight_up(3);
  for (PlaneRegion& plane : ideal.planes) plane.label = Label::unknown;
  const Stairs stairs = ideal.find();
  EXPECT_EQ(stairs.floor, 0);
  EXPECT_TRUE(stairs.flights.empty());
}

}  // namespace
}  // namespace planescope::planes
