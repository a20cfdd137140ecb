#include "core/lab/bench/command_times.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/model/error.hpp"

namespace planescope::lab {
namespace {

double in_ms(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

/// Runs it to its end and returns what it used.
rusage run_to_end(const TimedCommand& command) {
  std::vector<char*> args;
  for (const std::string& arg : command.args) args.push_back(const_cast<char*>(arg.c_str()));
  args.push_back(nullptr);
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawn(&child, args[0], &quiet, nullptr, args.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (failed != 0)
    throw Error(fmt::format("{}: cannot be started: {}", command.args[0], std::strerror(failed)));
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
  const auto wall_ms = interleaved_ms(commands.size(), rounds, before, [&](std::size_t c, int) {
    const rusage used = run_to_end(commands[c]);
    cpu_ms[c].push_back(in_ms(used.ru_utime) + in_ms(used.ru_stime));
    rows[c].peak_mib =
        std::max(rows[c].peak_mib, static_cast<double>(used.ru_maxrss) / 1024);  // from KiB
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
