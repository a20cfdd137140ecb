// Tests of gravity picked by the user and stored beside the recording.

#include <gtest/gtest.h>

#include "core/io/readers.hpp"
#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

/// Four depth frames, one with gravity from an IMU.
class Frames : public Recording {
 public:
  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return 4; }
  Frame frame(int i) const override {
    Frame frame;
    frame.index = i;
    if (i == 3) frame.gravity = Gravity{Vec3d::UnitX(), GravitySource::imu, 1, "imu"};
    return frame;
  }
  std::string frame_hash(int i) const override {
    if (i == damaged) throw Error("frame " + std::to_string(i) + " is damaged");
    return salt + std::to_string(i + removed);
  }
  std::string salt = "hash";
  int removed = 0;  // frames before the first
  int damaged = -1;

 private:
  RecordingInfo info_;
};

struct Picked : testing::Test {
  const fs::path dir = temp_dir() / (std::string("picked.") +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
  Frames recording;

  void SetUp() override { fs::remove_all(dir); }
  PickedDirection direction(int frame, const Vec3d& down) const {
    return {down, {}, frame, "hash" + std::to_string(frame), "picked: a floor"};
  }
  void write(const std::string& text) const { write_text(dir / "gravity.json", text); }
  std::string refusal() const {
    return message_of([&] { read_picked_gravity(dir, recording); });
  }
};

TEST_F(Picked, IsReadBackAsWritten) {
  PickedGravity picked;
  picked.recording = direction(1, Vec3d(0, 0.6, 0.8));
  picked.recording->walls = {Vec3d::UnitX(), Vec3d(0, 0.8, -0.6)};
  picked.frames[2] = direction(2, Vec3d::UnitY());
  write_picked_gravity(dir, picked);
  EXPECT_EQ(read_picked_gravity(dir, recording), picked);
  write_picked_gravity(dir, {});
  EXPECT_FALSE(fs::exists(dir / "gravity.json")) << "nothing is picked any more";
  EXPECT_TRUE(read_picked_gravity(dir, recording).empty());
  write_picked_gravity(dir, {});  // nothing to remove
}

TEST_F(Picked, AppliesToItsFrameFirstAndNeverOverridesTheRecording) {
  PickedGravity picked;
  picked.recording = direction(0, Vec3d(0, 0.6, 0.8));
  picked.frames[2] = direction(2, Vec3d(0, 0.8, 0.6));
  const auto with = with_picked_gravity(std::make_unique<Frames>(), picked);
  EXPECT_EQ(with->frame(1).gravity->direction, Vec3d(0, 0.6, 0.8));
  EXPECT_EQ(with->frame(1).gravity->source, GravitySource::picked);
  EXPECT_EQ(with->frame(2).gravity->direction, Vec3d(0, 0.8, 0.6));
  EXPECT_EQ(with->frame(3).gravity->source, GravitySource::imu);
  EXPECT_EQ(with->frame_hash(2), "hash2");
}

TEST_F(Picked, OfAnotherRecordingIsRejected) {
  PickedGravity picked;
  picked.recording = direction(1, Vec3d::UnitY());
  write_picked_gravity(dir, picked);
  recording.salt = "other";
  EXPECT_NE(refusal().find("gravity.json: was picked on a different recording"), std::string::npos)
      << refusal();
  recording.salt = "hash";
  recording.damaged = 1;
  EXPECT_EQ(refusal(), "") << "a damaged frame is told of where it is read";
  picked.recording->frame = 9;
  write_picked_gravity(dir, picked);
  EXPECT_NE(refusal().find("a different recording"), std::string::npos);
}

TEST_F(Picked, FollowsItsFrameToAnotherNumber) {
  PickedGravity picked;
  picked.recording = direction(2, Vec3d::UnitY());
  picked.frames[2] = direction(2, Vec3d(0, 0.6, 0.8));
  picked.frames[3] = direction(3, Vec3d::UnitX());
  write_picked_gravity(dir, picked);
  recording.removed = 1;
  const PickedGravity found = read_picked_gravity(dir, recording);
  EXPECT_EQ(found.recording->frame, 1);
  EXPECT_EQ(found.of(1)->direction, Vec3d(0, 0.6, 0.8));
  EXPECT_EQ(found.of(2)->direction, Vec3d::UnitX());
  EXPECT_EQ(found.frames.size(), 2u);
}

TEST_F(Picked, AnInvalidFileIsRejectedByName) {
  const auto file = [](const std::string& all, const std::string& frames) {
    return R"({"schema": "planescope.gravity/1", "recording": )" + all + R"(, "frames": )" +
           frames + "}";
  };
  const auto along = [](const std::string& direction) {
    return R"({"direction": )" + direction +
           R"(, "walls": [], "frame": 1, "frame_sha256": "hash1", "note": ""})";
  };
  const std::string one = along("[0,1,0]");
  for (const std::string& text :
       {std::string("{"), std::string("[]"), std::string("{}"), std::string("null"),
        std::string(R"({"schema": "planescope.gravity/2", "recording": null, "frames": []})"),
        file("7", "[]"), file("null", "7"), file("null", "[" + one + ", {}]"),
        file(along("[0,0,0]"), "[]"), file(along("[0,1]"), "[]")}) {
    write(text);
    EXPECT_EQ(refusal().find((dir / "gravity.json").string()), 0u) << text << ": " << refusal();
    EXPECT_EQ(refusal().find('\n'), std::string::npos) << refusal();
  }
  write(file("null", "[" + one + "]"));
  EXPECT_EQ(refusal(), "");
}

}  // namespace
}  // namespace planescope::io
