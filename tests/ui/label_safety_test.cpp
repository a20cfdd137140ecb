// What is labelled is written, or said not to be.

#include <fstream>

#include "app/desktop/state/session.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using LabelSafety = LabelDesktop;

TEST_F(LabelSafety, LeavingTheFrameSavesAndMarksIt) {
  window.run("label.take");
  EXPECT_TRUE(window.shows("frame.0.labels"));
  EXPECT_FALSE(fs::exists(label_dir / "000000.json"));
  window.run("frame.next");
  EXPECT_TRUE(fs::exists(label_dir / "000000.json"));
  EXPECT_TRUE(window.shows("frame.0.labels"));
  EXPECT_FALSE(window.shows("frame.1.labels"));
}

TEST_F(LabelSafety, ClosingTheWindowSaves) {
  const fs::path other = dir / "other";
  {
    LabelWindow closed(other);
    closed.run("label.take");
    EXPECT_FALSE(fs::exists(other / "000000.json"));
  }
  EXPECT_TRUE(fs::exists(other / "000000.json"));
}

TEST_F(LabelSafety, ASaveThatFailsSaysSoKeepsTheLabelsAndBarsNoWay) {
  window.run("label.take");
  const std::size_t planes = labels().planes.size();
  fs::create_directories(label_dir / "000000.plane.png.part" / "in the way");
  EXPECT_NE(window.refusal("label.save").find("000000.plane.png"), std::string::npos);
  EXPECT_NE(state().results.label.save_problem, "");
  window.run("frame.next");
  EXPECT_EQ(state().document.frame, 1);
  window.run("frame.previous");
  EXPECT_EQ(labels().planes.size(), planes);
  fs::remove_all(label_dir / "000000.plane.png.part");
  window.run("label.save");
  EXPECT_EQ(state().results.label.save_problem, "");
  EXPECT_TRUE(fs::exists(label_dir / "000000.plane.png"));
}

TEST_F(LabelSafety, ASecondWindowReadsOnlyAndSaysWho) {
  window.run("label.take");
  LabelWindow second(label_dir);
  EXPECT_NE(second.store().read_only().find("held by"), std::string::npos);
  EXPECT_EQ(second.labels().planes.size(), labels().planes.size());
  EXPECT_NE(second.refusal("label.remove", "1").find("held by"), std::string::npos);
  EXPECT_EQ(second.labels().planes.size(), labels().planes.size());
  EXPECT_TRUE(second.shows("status.right"));
}

TEST_F(LabelSafety, ASessionLeavesTheModeAndTheFolderOfTheLabels) {
  window.run("label.take");
  window.run("session.save", (dir / "a.session").string());
  window.run("session.open", (dir / "a.session").string());
  EXPECT_EQ(state().view.mode, Mode::debugger);
  EXPECT_TRUE(fs::exists(label_dir / "000000.json"));
  EXPECT_EQ(state().document.current()->label_dir, label_dir);
  window.run("label.mode");
  EXPECT_FALSE(labels().planes.empty());
}

TEST_F(LabelSafety, FramesLabelledEarlierAreMarkedOnceTheModeIsEntered) {
  window.run("frame.show", "1");
  window.run("label.take");
  window.run("label.save");
  const fs::path copy = dir / "copy";
  fs::copy(label_dir, copy, fs::copy_options::recursive);
  LabelWindow again(copy);
  EXPECT_TRUE(again.shows("frame.1.labels"));
  EXPECT_FALSE(again.shows("frame.2.labels"));
}

TEST_F(LabelSafety, DamagedFilesAreNotInTheWayOfTheJournal) {
  window.run("label.take");
  const std::size_t planes = labels().planes.size();
  window.run("label.save");
  const fs::path copy = dir / "copy";
  fs::copy(label_dir, copy, fs::copy_options::recursive);
  std::ofstream(copy / "000000.plane.png") << "no picture";
  LabelWindow again(copy);
  EXPECT_EQ(again.labels().planes.size(), planes);
  EXPECT_NE(again.state().view.message.find("000000.plane.png"), std::string::npos);
  again.run("label.save");
  EXPECT_EQ(labels::read_frame_labels(copy, 0, "")->planes.size(), planes);
}

TEST_F(LabelSafety, WhatOthersChangedIsTold) {
  window.run("label.take");
  window.run("label.save");
  const fs::path copy = dir / "copy";
  fs::copy(label_dir, copy, fs::copy_options::recursive);
  FrameLabels others = labels();
  others.annotator = "other tool";
  labels::write_frame_labels(copy, 0, others);
  LabelWindow again(copy);
  EXPECT_NE(again.state().view.message.find("changed outside"), std::string::npos);
}

TEST_F(LabelSafety, WhoMayOnlyReadIsNotToldThatLabelsWereWritten) {
  window.run("label.take");
  LabelWindow second(label_dir);
  EXPECT_NE(second.refusal("label.save").find("held by"), std::string::npos);
}

}  // namespace
}  // namespace planescope::desktop
