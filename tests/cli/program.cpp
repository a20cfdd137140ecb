// Starts the built programs as child processes and collects their output.

#include "cli/program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace planescope::testing_cli {
namespace fs = std::filesystem;
namespace {

pid_t start(const std::vector<std::string>& args,
            const fs::path& out,
            const fs::path& err,
            const std::function<void()>& before = {}) {
  std::vector<std::string> words = args;
  if (!words.empty() && words[0] == "planescope-lab")
    words[0] = PLANESCOPE_LAB;
  else
    words.insert(words.begin(), PLANESCOPE_PROGRAM);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t pid = fork();
  if (pid != 0) return pid;
  const auto redirect = [](const char* path, int flags, int fd) {
    const int opened = open(path, flags, 0600);
    if (opened < 0 || dup2(opened, fd) < 0) _exit(99);
  };
  redirect("/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  redirect(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  if (before) before();
  execv(argv[0], argv.data());
  _exit(98);
}

// A file name that no other run uses.
fs::path fresh_name(const std::string& what) {
  static std::atomic<int> count = 0;
  return fs::path(testing::TempDir()) / ("planescope_cli_" + std::to_string(getpid()) + "_" +
                                         std::to_string(count++) + "_" + what);
}

/// Waits until the file exists or the process has ended.
void wait_for(const fs::path& marker, pid_t pid) {
  const auto runs = [pid] {
    siginfo_t ended = {};
    waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOHANG | WNOWAIT);
    return ended.si_pid == 0;
  };
  while (!fs::exists(marker) && runs()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

Ran finish(pid_t pid, const fs::path& out, const fs::path& err) {
  int status = 0;
  rusage usage = {};
  wait4(pid, &status, 0, &usage);
  Ran ran;
  ran.peak_kb = usage.ru_maxrss;
  ran.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  ran.out = read_text(out);
  ran.err = read_text(err);
  fs::remove(out);
  fs::remove(err);
  return ran;
}

}  // namespace

Ran run(const std::vector<std::string>& args, const std::function<void()>& before) {
  const fs::path out = fresh_name("out"), err = fresh_name("err");
  return finish(start(args, out, err, before), out, err);
}

std::string typeset(const std::string& words) {
  const fs::path out = fresh_name("tables");
  const std::string command =
      PLANESCOPE_SOURCE_DIR "/scripts/typeset " + words + " >" + out.string() + " 2>&1";
  const int status = std::system(command.c_str());
  const std::string text = read_text(out);
  EXPECT_EQ(status, 0) << text;
  fs::remove(out);
  return text;
}

Ran run_and_signal(const std::vector<std::string>& args,
                   int signal_number,
                   const fs::path& marker) {
  const fs::path out = fresh_name("out"), err = fresh_name("err");
  const pid_t pid = start(args, out, err);
  wait_for(marker, pid);
  kill(pid, signal_number);
  return finish(pid, out, err);
}

Ran run_and_then(const std::vector<std::string>& args,
                 const fs::path& marker,
                 const std::function<void()>& then) {
  const fs::path out = fresh_name("out"), err = fresh_name("err");
  const pid_t pid = start(args, out, err);
  wait_for(marker, pid);
  then();
  return finish(pid, out, err);
}

Environment::Environment(const char* variable, const std::string& value) : name(variable) {
  setenv(name, value.c_str(), 1);
}
Environment::~Environment() { unsetenv(name); }

fs::path scratch() {
  const fs::path dir = fresh_name("dir");
  fs::remove_all(dir);
  fs::create_directories(dir);
  return dir;
}

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> files_below(const fs::path& dir) {
  std::vector<std::string> files;
  if (!fs::exists(dir)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(dir))
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), dir).string());
  std::sort(files.begin(), files.end());
  return files;
}

Ran well(Ran ran) {
  EXPECT_EQ(ran.code, 0) << ran.out << ran.err;
  return ran;
}

void expect_refused(const Ran& ran, const std::string& part) {
  EXPECT_EQ(ran.code, 2) << ran.out;
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_TRUE(has(ran.err, part));
}

bool is_one_line(const std::string& err) {
  return (err.starts_with("planescope: ") || err.starts_with("planescope-lab: ")) &&
         err.find('\n') == err.size() - 1;
}

}  // namespace planescope::testing_cli
