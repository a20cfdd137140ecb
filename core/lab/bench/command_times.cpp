#include "core/lab/bench/command_times.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "core/model/error.hpp"

namespace planescope::lab {
namespace {

double in_ms(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

/// The most that a child has had resident, looked at every millisecond until it ends. (What wait4
/// tells begins with what this process has: a child that is spawned starts in its memory.)
double followed_peak_mib(pid_t child) {
  double peak_mib = 0;
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == 0) {
    const std::string status = fmt::format("/proc/{}/status", child);
    peak_mib = std::max(peak_mib, resident_memory(status).peak_mib);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return peak_mib;
}

/// Runs it to its end and returns what it used; its peak of memory where that is asked for.
rusage run_to_end(const TimedCommand& command, double* peak_mib = nullptr) {
  std::vector<char*> args;
  for (const std::string& arg : command.args) args.push_back(const_cast<char*>(arg.c_str()));
  args.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // A group and signals of its own: who stops this program with Ctrl+C ends no child half-way,
  // which would look as if it had failed.
  posix_spawnattr_t apart;
  posix_spawnattr_init(&apart);
  posix_spawnattr_setflags(&apart, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&apart, &none);
  pid_t child = 0;
  const int failed = posix_spawn(&child, args[0], &quiet, &apart, args.data(), environ);
  posix_spawnattr_destroy(&apart);
  posix_spawn_file_actions_destroy(&quiet);
  if (failed != 0)
    throw Error(fmt::format("{}: cannot be started: {}", command.args[0], std::strerror(failed)));
  if (peak_mib) *peak_mib = followed_peak_mib(child);
  int status = 0;
  rusage used{};
  while (wait4(child, &status, 0, &used) < 0)
    if (errno != EINTR)
      throw Error(fmt::format("{}: was lost: {}", command.args[0], std::strerror(errno)));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(fmt::format("{} ended with {}, expected success", fmt::join(command.args, " "),
                            WIFEXITED(status) ? fmt::format("exit code {}", WEXITSTATUS(status))
                                              : fmt::format("signal {}", WTERMSIG(status))));
  return used;
}

}  // namespace

std::vector<CommandRow> measure_commands(std::span<const TimedCommand> commands,
                                         int rounds,
                                         const std::function<void()>& before) {
  std::vector<std::vector<double>> cpu_ms(commands.size());
  std::vector<CommandRow> rows(commands.size());
  for (std::size_t c = 0; c < commands.size(); ++c) {
    before();
    run_to_end(commands[c], &rows[c].peak_mib);  // apart: looking takes time
  }
  const auto wall_ms = interleaved_ms(commands.size(), rounds, before, [&](std::size_t c, int) {
    const rusage used = run_to_end(commands[c]);
    cpu_ms[c].push_back(in_ms(used.ru_utime) + in_ms(used.ru_stime));
  });
  for (std::size_t c = 0; c < commands.size(); ++c) {
    rows[c].name = commands[c].name;
    rows[c].wall_ms = times_of(wall_ms[c]);
    cpu_ms[c].erase(cpu_ms[c].begin());  // of the first round, which does not count
    rows[c].cpu_ms = times_of(cpu_ms[c]);
  }
  return rows;
}

}  // namespace planescope::lab
