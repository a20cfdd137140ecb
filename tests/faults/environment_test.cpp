// Unusual environments: no home folder, no permission to write, little memory or few files, other
// locales, and names that are not valid text.

#include <fcntl.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "faults/fault.hpp"

namespace planescope::faults {
namespace {

namespace fs = std::filesystem;
using namespace testing_cli;
using Json = nlohmann::json;

constexpr unsigned kLongestS = 60;
constexpr uid_t kNobody = 65534;

class Environment : public testing::Test {
 protected:
  void SetUp() override {
    write_depth_folder(rec, floor_and_wall(), 2);
    fs::permissions(dir, fs::perms::all);
  }
  void TearDown() override { fs::remove_all(dir); }

  std::vector<std::string> segment(const fs::path& out) const {
    return {"segment", rec.string(), "-o", out.string(), "--gravity", "0,1,0", "--threads", "2"};
  }
  static Ran run_in(const std::vector<std::string>& args, const std::function<void()>& before) {
    return run(args, [&] {
      alarm(kLongestS);
      before();
    });
  }
  static void limit(int what, rlim_t value) {
    const rlimit both{value, value};
    setrlimit(static_cast<__rlimit_resource_t>(what), &both);
  }
  static void expect_one_line(const Ran& ran, int code = 2) {
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  }

  const fs::path dir = scratch(), rec = dir / "rec";
};

void become_nobody() {
  if (setgroups(0, nullptr) != 0 || setgid(kNobody) != 0 || setuid(kNobody) != 0) _exit(97);
}

// ---- Folders ----

TEST_F(Environment, WithoutAHomeCommandsWorkAndTheWindowStoresNothing) {
  const auto homeless = [] {
    for (const char* name : {"HOME", "XDG_STATE_HOME", "DISPLAY", "WAYLAND_DISPLAY"})
      unsetenv(name);
  };
  EXPECT_EQ(run_in(segment(dir / "out"), homeless).code, 0);
  write_text(dir / "script.json", R"({"actions": ["label.mode", "label.take", "label.save"]})");
  const Ran view = run_in({"view", rec.string(), "--offscreen", "--gravity", "0,1,0", "--script",
                           (dir / "script.json").string(), "--size", "640x400"},
                          homeless);
  EXPECT_EQ(view.code, 0) << view.err;
  EXPECT_TRUE(fs::exists(dir / "rec.labels" / "000000.json"));
}

TEST_F(Environment, AReadOnlyFolderIsReportedBeforeProcessing) {
  if (getuid() != 0) GTEST_SKIP() << "needs to be root, to become somebody who may write nowhere";
  fs::create_directories(dir / "closed" / "out");
  write_text(dir / "closed" / "out" / "planes.json", "of before");
  for (const std::vector<std::string>& args :
       {segment(dir / "closed" / "out"),
        {"report", rec.string(), "-o", (dir / "closed" / "out").string(), "--gravity", "0,1,0"},
        {"synth", "sample", "-o", (dir / "closed" / "new").string()},
        {"view", rec.string(), "--screenshot", (dir / "closed" / "a.png").string(), "--gravity",
         "0,1,0"}}) {
    const Ran ran = run_in(args, become_nobody);
    expect_one_line(ran);
    EXPECT_NE(ran.err.find((dir / "closed").string()), std::string::npos) << ran.err;
  }
  EXPECT_EQ(files_below(dir / "closed"), std::vector<std::string>{"out/planes.json"});
}

TEST_F(Environment, LabelsInAReadOnlyFolderAreReadAndGesturesAreRejected) {
  if (getuid() != 0) GTEST_SKIP() << "needs to be root, to become somebody who may write nowhere";
  fs::create_directories(dir / "rec.labels");
  write_text(dir / "script.json", R"({"actions": ["label.mode", "label.take"]})");
  const Ran ran = run_in({"view", rec.string(), "--offscreen", "--gravity", "0,1,0", "--script",
                          (dir / "script.json").string(), "--size", "640x400"},
                         [&] {
                           setenv("HOME", "/proc", 1);
                           unsetenv("XDG_STATE_HOME");
                           become_nobody();
                         });
  expect_one_line(ran);
  EXPECT_NE(ran.err.find("read-only"), std::string::npos) << ran.err;
}

// ---- Limits ----

TEST_F(Environment, SixteenOpenFilesAndASmallStackAreEnough) {
  EXPECT_EQ(run_in(segment(dir / "few"), [] { limit(RLIMIT_NOFILE, 16); }).code, 0);
  EXPECT_EQ(run_in(segment(dir / "small"), [] { limit(RLIMIT_STACK, 256 * 1024); }).code, 0);
  const auto report = [&](const char* out) {
    return std::vector<std::string>{"report",    rec.string(), "-o",           (dir / out).string(),
                                    "--gravity", "0,1,0",      "--no-pictures"};
  };
  EXPECT_EQ(run_in(report("a"), [] { limit(RLIMIT_NOFILE, 16); }).code, 0);
  EXPECT_EQ(run_in(report("b"), [] { limit(RLIMIT_STACK, 256 * 1024); }).code, 0);
}

// In small steps near the limit, where the last allocation can fail anywhere: in a library, while a
// document is freed, in a thread.
TEST_F(Environment, LittleMemoryIsEnoughOrIsReportedInOneLine) {
  bool worked = false;
  for (rlim_t bytes = 150'000'000; bytes <= 400'000'000;
       bytes += bytes < 250'000'000 ? 4'000'000 : 60'000'000) {
    SCOPED_TRACE(bytes);
    if (run_in({"--version"}, [&] { limit(RLIMIT_AS, bytes); }).code != 0) continue;
    const Ran ran = run_in(segment(dir / "out"), [&] { limit(RLIMIT_AS, bytes); });
    worked |= ran.code == 0;
    if (ran.code == 0) continue;
    expect_one_line(ran);
    EXPECT_NE(ran.err.find("out of memory"), std::string::npos) << ran.err;
  }
  if (run_in({"--version"}, [] { limit(RLIMIT_AS, 400'000'000); }).code != 0)
    GTEST_SKIP() << "this build does not start in so little memory";
  EXPECT_TRUE(worked);
}

// ---- Standard streams ----

TEST_F(Environment, ClosedStandardStreamsAreToldAndNoFileHoldsTheirText) {
  ASSERT_EQ(run_in(segment(dir / "out"), [] {}).code, 0);
  const Snapshot expected = snapshot(dir / "out");
  for (const int first : {STDOUT_FILENO, STDIN_FILENO}) {
    fs::remove_all(dir / "out");
    const Ran ran = run_in(segment(dir / "out"), [&] {
      for (int file = first; file <= (first == STDIN_FILENO ? 2 : first); ++file) close(file);
    });
    EXPECT_EQ(ran.code, 2);
    if (first == STDOUT_FILENO) expect_one_line(ran);
    EXPECT_EQ(differences(snapshot(dir / "out"), expected), "");
  }
  const Ran full = run_in({"info", (dir / "missing").string()}, [] {
    if (dup2(open("/dev/full", O_WRONLY), STDERR_FILENO) < 0) _exit(97);
  });
  EXPECT_EQ(full.code, 2) << "a message that cannot be written changes nothing";
}

TEST_F(Environment, AReaderThatLeavesEndsTheProgramInSilence) {
  const auto to_nobody = [] {
    int ends[2];
    if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) _exit(97);
    close(ends[0]);
    close(ends[1]);
  };
  const Ran info = run_in({"info", rec.string()}, to_nobody);
  EXPECT_EQ(info.code, 128 + SIGPIPE);
  EXPECT_EQ(info.err, "");
  // Where the signal is ignored, as in some shells and services.
  expect_one_line(run_in({"info", rec.string()}, [&] {
    signal(SIGPIPE, SIG_IGN);
    to_nobody();
  }));
  EXPECT_EQ(run_in(segment(dir / "out"), to_nobody).code, 128 + SIGPIPE);
  EXPECT_EQ(files_below(dir / "out").size(), 8U) << "the files are whole";
}

// ---- Locales and names ----

class Locales : public Environment, public testing::WithParamInterface<const char*> {};

/// Builds the locale from its source where the system has one. False where it has none.
bool build_locale(const fs::path& folder, const std::string& name) {
  fs::create_directories(folder);
  const std::string command = "localedef -i " + name.substr(0, name.find('.')) + " -f UTF-8 '" +
                              (folder / name).string() + "' >/dev/null 2>&1";
  [[maybe_unused]] const int status = std::system(command.c_str());
  return fs::exists(folder / name);
}

TEST_P(Locales, OutputsAreTheSameBytes) {
  const std::string locale = GetParam();
  const bool has_source = locale.ends_with(".UTF-8") && locale != "C.UTF-8";
  if (has_source && !build_locale(dir / "locales", locale))
    GTEST_SKIP() << locale << " is not installed";
  std::vector<std::string> args = segment(dir / "out");
  args.insert(args.end(), {"--also", "geojson,obj,ply,csv,svg", "--voxel", "0.025"});
  const auto run_with = [&](const std::string& name) {
    return run_in(args, [&] {
      if (has_source) setenv("LOCPATH", (dir / "locales").c_str(), 1);
      setenv("LC_ALL", name.c_str(), 1);
    });
  };
  const Ran plain = well(run_with("C"));
  const Snapshot expected = snapshot(dir / "out");
  const Ran ran = well(run_with(locale));
  EXPECT_EQ(ran.out, plain.out);
  EXPECT_EQ(differences(snapshot(dir / "out"), expected), "");
  args.back() = "0,025";
  expect_one_line(run_with(locale));
}

INSTANTIATE_TEST_SUITE_P(All,
                         Locales,
                         testing::Values("de_DE.UTF-8", "tr_TR.UTF-8", "C.UTF-8", "xx_YY.broken"),
                         [](const auto& locale) {
                           return std::string(locale.param, 2 - (*locale.param == 'C'));
                         });

TEST_F(Environment, NamesMayBeInvalidTextOrContainNewlinesAndQuotes) {
  for (const std::string name : {"latin\xe9", "two\nlines", "q'uo\"te", "tab\tand space ", "-o"}) {
    SCOPED_TRACE(name);
    const fs::path odd = dir / name;
    fs::create_directories(odd);
    fs::copy(rec, odd / name, fs::copy_options::recursive);
    const fs::path out = odd / "out";
    const Ran segmented =
        run({"segment", (odd / name).string(), "-o", out.string(), "--gravity", "0,1,0", "--json"});
    EXPECT_EQ(segmented.code, 0) << segmented.err;
    EXPECT_TRUE(Json::accept(segmented.out)) << segmented.out;
    const Ran reported = run({"report", (odd / name).string(), "-o", out.string(), "--gravity",
                              "0,1,0", "--no-pictures"});
    EXPECT_EQ(reported.code, 0) << reported.err;
    EXPECT_TRUE(Json::accept(read_text(out / "report.json")));
    const Ran missing = run({"segment", (odd / (name + "none")).string(), "-o", out.string()});
    expect_one_line(missing);
  }
}

// ---- Files that disappear while open, and names that lead elsewhere ----

TEST_F(Environment, ARecordingRemovedWhileOpenIsReportedInOneLine) {
  write_depth_folder(rec, floor_and_wall(), 8);
  write_text(dir / "script.json", R"({"actions": [{"state": ")" + (dir / "open.json").string() +
                                      R"("}, "frame.last", {"expect": {"frame": 7}}, "label.mode",
      "label.take", "label.save"]})");
  const Ran ran = run_and_then({"view", rec.string(), "--offscreen", "--gravity", "0,1,0", "--size",
                                "640x400", "--script", (dir / "script.json").string()},
                               dir / "open.json", [&] { fs::remove_all(rec); });
  EXPECT_TRUE(ran.code == 0 || ran.code == 1 || ran.code == 2) << ran.code << ran.err;
  if (ran.code != 0) {
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  }
}

/// File names read from inputs must not lead out of their folder.
TEST_F(Environment, NamesInFilesNeverLeadOutOfTheFolder) {
  const fs::path outside = dir / "outside.png";
  write_text(outside, "of somebody else");
  const auto before = files_below(dir);
  const std::string sidecar =
      R"({"schema": "planescope.recording/1", "depth_unit_m": 0.001, "gravity": [0, 1, 0],
          "intrinsics": {"width": 160, "height": 120, "fx": 120, "fy": 120, "cx": 80, "cy": 60},
          "frames": [{"name": "../../outside"}, {"name": ")" +
      (dir / "outside").string() + R"("}]})";
  write_text(rec / "planescope.json", sidecar);
  const Ran sided = run({"report", rec.string(), "-o", (dir / "out").string(), "--no-pictures"});
  if (sided.code != 0) expect_one_line(sided);
  fs::remove(rec / "planescope.json");
  fs::remove_all(dir / "out");

  // Shards of a report: the names of their recordings become folders when they are joined.
  const auto shard = [&](const char* part) {
    const fs::path out = dir / "out" / part;
    const Ran ran = run({"report", rec.string(), rec.string(), "-o", out.string(), "--no-pictures",
                         "--gravity", "0,1,0", "--shard", std::string(part) + "/2"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return out;
  };
  const fs::path first = shard("1"), second = shard("2");
  for (const std::string& name : {std::string("../../outside"), (dir / "outside").string()}) {
    for (const fs::path& part : {first, second}) {
      Json report = Json::parse(read_text(part / "report.json"));
      report["recordings"][0]["name"] = name;
      write_text(part / "report.json", report.dump());
    }
    const Ran merged = run({"report", "merge", first.string(), second.string(), "-o",
                            (dir / "in" / "deep" / "merged").string()});
    expect_one_line(merged);
    EXPECT_NE(merged.err.find("expected a file name"), std::string::npos) << merged.err;
    EXPECT_FALSE(fs::exists(dir / "in"));
  }
  fs::remove_all(dir / "out");
  EXPECT_EQ(files_below(dir), before) << "nothing is written elsewhere";
  EXPECT_EQ(read_text(outside), "of somebody else");
}

TEST_F(Environment, ArchivesAndImageListsNeverLeadOutOfTheFolder) {
  const auto before = files_below(dir);
  write_text(dir / "in.json", R"({"images": [{"id": 1, "file_name": "../../x.png", "width": 160,
      "height": 120}], "categories": [{"id": 1, "name": "/etc/x"}], "annotations": [{"id": 1,
      "image_id": 1, "category_id": 1, "segmentation": [[10, 10, 50, 10, 50, 50]], "bbox":
      [10, 10, 40, 40], "area": 800, "iscrowd": 0}]})");
  const Ran ran = run({"labels", "import", rec.string(), "--format", "coco", "--from",
                       (dir / "in.json").string(), "--frames", "0", "--gravity", "0,1,0",
                       "--labels", (dir / "deep" / "labels").string()});
  if (ran.code != 0) expect_one_line(ran);
  fs::remove_all(dir / "deep");
  fs::remove(dir / "in.json");
  EXPECT_EQ(files_below(dir), before);
}

}  // namespace
}  // namespace planescope::faults
