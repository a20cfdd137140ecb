// Tests of the history of tracks, and of track filters.

#include <gtest/gtest.h>

#include "core/model/error.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {
namespace {

Track made_track() {
  Track track(0.02);
  track.id = 12;
  track.label = Label::h;
  track.born = 30;
  for (const int frame : {30, 31, 32, 36, 37}) {
    Sighting sighting;
    sighting.frame = frame;
    sighting.plane = 4;
    sighting.pixels = 2310;
    sighting.founding = frame == 30;
    sighting.angle_deg = 0.3f;
    sighting.offset_m = 0.0012f;
    track.sightings.push_back(sighting);
  }
  track.frames_seen = 5;
  track.gaps.push_back({.first = 33,
                        .last = 35,
                        .frames = 3,
                        .why = Absence::not_matched,
                        .plane = 7,
                        .term = {Term::angle_deg, 7.25, 5.1}});
  track.gaps.push_back({.first = 38, .last = 40, .frames = 3, .why = Absence::out_of_view});
  return track;
}

TEST(History, ShowsTheStateOfATrackInAFrame) {
  const Tracker tracker;
  const Track track = made_track();
  EXPECT_EQ(moment_text(tracker, track, 29), "T12 is not in frame 29: first seen in frame 30");
  EXPECT_EQ(moment_text(tracker, track, 30),
            "T12 is P4 of frame 30, 2310 px: seen for the first time");
  EXPECT_EQ(moment_text(tracker, track, 31),
            "T12 is P4 of frame 31, 2310 px, 0.30° and 1.2 mm from the track");
  EXPECT_EQ(moment_text(tracker, track, 33),
            "T12 is not in frame 33: not matched, its region is on P7, angle_deg 7.25 > 5.1");
  EXPECT_EQ(moment_text(tracker, track, 34), "T12 is not in frame 34: not matched, since frame 33");
  EXPECT_EQ(moment_text(tracker, track, 39), "T12 is not in frame 39: out of view");
  EXPECT_TRUE(moment_of(track, 34).is_unlisted());
  EXPECT_FALSE(moment_of(track, 39).is_unlisted());
  EXPECT_FALSE(moment_of(track, 31).is_unlisted());
}

TEST(History, ShowsThatThePlaneWasUndecided) {
  Track track = made_track();
  track.sightings[1].undecided = true;
  EXPECT_EQ(moment_text(Tracker(), track, 31),
            "T12 is P4 of frame 31, 2310 px, undecided, 0.30° and 1.2 mm from the track");
}

TEST(History, ListsNoPlaneIfATrackHasOnlyAMinorOne) {
  Track track = made_track();
  track.sightings[1].minor = true;
  EXPECT_EQ(moment_text(Tracker(), track, 31),
            "T12 is a minor plane of frame 31, 2310 px, below the listing threshold");
  EXPECT_TRUE(moment_of(track, 31).is_unlisted());
}

TEST(TrackFilter, SelectsMatchingTracks) {
  const Tracker tracker;
  const Track track = made_track();
  const auto matches = [&](const std::string& text) {
    return TrackFilter(text).matches(tracker, track);
  };
  for (const char* text : {"", "  ", "gap", "length<=5 && h", "track==12 && frame==34", "!merged",
                           "! v", "gaps==1", "frame==39", "born>=30"})
    EXPECT_TRUE(matches(text)) << text;
  for (const char* text : {"length<5", "v", "!gap", "frame==29", "track!=12", "gone", "h && v"})
    EXPECT_FALSE(matches(text)) << text;
}

TEST(TrackFilter, ReportsTheInvalidWord) {
  const auto problem = [](const std::string& text) -> std::string {
    try {
      TrackFilter filter(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_NE(problem("lenght<5").find("'lenght'"), std::string::npos);
  EXPECT_NE(problem("length<five").find("'five'; expected a number"), std::string::npos);
  EXPECT_NE(problem("gaps &&").find("a condition after &&"), std::string::npos);
  EXPECT_NE(problem("stair").find("'stair'"), std::string::npos);
  EXPECT_NE(problem("frame<3").find("frame==N"), std::string::npos);
  EXPECT_NE(problem("length=5").find("==, !="), std::string::npos);
}

}  // namespace
}  // namespace planescope::world
