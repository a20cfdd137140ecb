// Runs the program on every recording in real_data.json, with the command given there, and checks
// the planes. Recordings are read from $PLANESCOPE_DATA. Results are identical on every machine:
// real_data.sha256 contains a hash of each run's planes.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "core/model/file_bytes.hpp"
#include "support/temp_dir.hpp"
#include "tests/real/expectations.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Case {
  std::string name;
  Json json;
};

// CTest prints this beside the test's name.
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> read_cases() {
  std::ifstream file(fs::path(PLANESCOPE_SOURCE_DIR) / "tests" / "real_data.json");
  const Json list = Json::parse(file);
  std::vector<Case> cases;
  for (const Json& entry : list.at("recordings"))
    cases.push_back({entry.at("name").get<std::string>(), entry});
  return cases;
}

std::string read_text(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Result of a command from the list, "planescope segment ...", run in the recordings' folder.
struct Outcome {
  int exit_code = -1;
  std::string said;  // stderr
};

Outcome run_command(const std::string& command,
                    const fs::path& data,
                    const fs::path& out,
                    const std::string& environment = "") {
  const fs::path log = out.string() + ".log";
  const std::string arguments = command.substr(std::string("planescope ").size());
  const std::string line =
      fmt::format("cd '{}' && {} '{}' {} -o '{}' >'{}' 2>&1 </dev/null", data.string(), environment,
                  PLANESCOPE_BINARY, arguments, out.string(), log.string());
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(log)};
}

/// Hash of the planes of all frames in planes.json.
std::string hash_of_planes(const fs::path& out) {
  std::vector<fs::path> frames(fs::directory_iterator(out / "frames"), {});
  std::sort(frames.begin(), frames.end());
  std::string text;
  for (const fs::path& frame : frames) {
    Json planes = Json::parse(read_text(frame / "planes.json")).at("planes");
    for (Json& plane : planes)
      for (const char* made_from_it : {"outline", "outline_area_m2", "height_m", "surface",
                                       "certainty", "foot", "margin", "undecided"})
        plane.erase(made_from_it);
    text += planes.dump();
  }
  return sha256_hex(std::as_bytes(std::span(text)));
}

std::string expected_hash(const std::string& name) {
  std::ifstream file(fs::path(PLANESCOPE_SOURCE_DIR) / "tests" / "real_data.sha256");
  for (std::string hash, of; file >> hash >> of;)
    if (of == name) return hash;
  return "none";
}

/// After intended changes of planes, update the hashes.
void expect_same_planes(const Case& c, const fs::path& out) {
  const std::string found = hash_of_planes(out);
  EXPECT_EQ(found, expected_hash(c.name))
      << "other planes than when tests/real_data.sha256 was written; its line is now\n"
      << found << "  " << c.name;
}

class RealRecording : public testing::TestWithParam<Case> {};

TEST_P(RealRecording, HasThePlanesExpected) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Json& json = GetParam().json;
  const fs::path out = temp_dir() / ("real_" + GetParam().name);
  fs::remove_all(out);

  const Outcome run = run_command(json.at("command").get<std::string>(), data, out);
  const int expected_exit = json.value("exit", 0);
  ASSERT_EQ(run.exit_code, expected_exit) << json.at("command") << "\n" << run.said;
  if (expected_exit != 0) {
    EXPECT_NE(run.said.find(json.at("says").get<std::string>()), std::string::npos) << run.said;
    EXPECT_FALSE(fs::exists(out)) << "something was written to " << out;
    return;
  }

  for (const auto& [frame, listed] : json.at("frames").items()) {
    Json expectations = listed;
    const auto of_flights = [](const Json& e) { return e.at("kind") == "flights"; };
    if (std::ranges::none_of(expectations, of_flights))
      expectations.push_back({{"kind", "flights"}, {"heights", Json::array()}});
    const FrameOutput output =
        read_frame_output(out / "frames" / fmt::format("{:06}", std::stoi(frame)));
    std::vector<std::string> problems = check_consistency(output);
    for (const Json& expectation : expectations)
      for (std::string& problem : check_expectation(expectation, output))
        problems.push_back(std::move(problem));
    for (const std::string& problem : problems)
      ADD_FAILURE() << "frame " << frame << ": " << problem;
  }
  expect_same_planes(GetParam(), out);
  if (!HasFailure()) fs::remove_all(out);
}

TEST_P(RealRecording, HasTheSamePlanesWithPlainCodeOnOneThread) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Json& json = GetParam().json;
  if (json.value("exit", 0) != 0) GTEST_SKIP() << "is refused";
  const fs::path out = temp_dir() / ("real_plain_" + GetParam().name);
  fs::remove_all(out);
  const Outcome run = run_command(json.at("command").get<std::string>() + " --threads 1", data, out,
                                  "PLANESCOPE_SIMD=plain");
  ASSERT_EQ(run.exit_code, 0) << run.said;
  expect_same_planes(GetParam(), out);
  if (!HasFailure()) fs::remove_all(out);
}

INSTANTIATE_TEST_SUITE_P(,
                         RealRecording,
                         testing::ValuesIn(read_cases()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace planescope
