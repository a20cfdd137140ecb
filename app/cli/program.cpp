// Parses the command line, runs the command, and turns errors and signals into exit codes.

#include "app/cli/program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <system_error>
#include <thread>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "app/cli/output.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::app {
namespace {

// The handler may only do what is async-signal-safe: it writes one byte, and a thread that waits
// for that byte asks for the stop.
int g_signal_fd = -1;

void on_signal(int) {
  const int saved = errno;
  const char byte = 's';
  [[maybe_unused]] const ssize_t written = write(g_signal_fd, &byte, 1);
  errno = saved;
}

void handle(int signal_number, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART | SA_RESETHAND;  // a second signal ends the process
  sigaction(signal_number, &action, nullptr);
}

/// Turns the first SIGINT or SIGTERM into a stop request, so that work ends at the next frame with
/// valid output. A second one ends the program at once. One per process.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  int pipe_[2] = {-1, -1};
  std::thread watcher_;
};

Interrupt::Interrupt() {
  if (pipe2(pipe_, O_CLOEXEC) != 0) throw Error("cannot handle signals: cannot create a pipe");
  g_signal_fd = pipe_[1];
  watcher_ = std::thread([this] {
    char byte = 0;
    while (true) {
      const ssize_t got = read(pipe_[0], &byte, 1);
      if (got < 0 && errno == EINTR) continue;
      if (got == 1 && byte == 's') source_.request_stop();
      if (got == 1 && byte == 's') continue;
      return;
    }
  });
  handle(SIGINT, on_signal);
  handle(SIGTERM, on_signal);
}

Interrupt::~Interrupt() {
  handle(SIGINT, SIG_DFL);
  handle(SIGTERM, SIG_DFL);
  const char byte = 'q';
  [[maybe_unused]] const ssize_t written = write(pipe_[1], &byte, 1);
  watcher_.join();
  close(pipe_[0]);
  close(pipe_[1]);
}

/// Reserve for running out of memory. Destroying a JSON document allocates in a destructor, where
/// bad_alloc would end the program; printing the error message allocates too. Each failed
/// allocation frees one block, and several threads may run out of memory at the same time.
constexpr std::size_t kReserveBytes = 1 << 20;
std::array<void*, 8> g_reserve;
std::atomic<std::size_t> g_given_back = 0;

void set_reserve_aside() {
  for (void*& block : g_reserve) block = std::malloc(kReserveBytes);
  std::set_new_handler([] {
    const std::size_t next = g_given_back++;
    if (next < g_reserve.size()) std::free(g_reserve[next]);
    const bool may_be_destructor = std::uncaught_exceptions() > 0;
    if (!may_be_destructor || next >= g_reserve.size()) throw std::bad_alloc();
  });
}

/// Keeps freed memory in the process, because the next frame needs as much again. Otherwise the
/// megabytes of each frame are unmapped and mapped again, and clearing their pages takes up to a
/// tenth of all CPU time.
void keep_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the maximum that glibc accepts
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`") == std::string::npos)
    return word;
  std::string inner;
  for (const char c : word) inner += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return fmt::format("'{}'", inner);
}

/// The command line, quoted so that it can be pasted into a shell.
std::string command_text(const Program& program, int argc, char** argv) {
  std::string text = program.name;
  for (int i = 1; i < argc; ++i) text.append(1, ' ').append(shell_word(argv[i]));
  return text;
}

/// The command line without the options that do not affect a report's frames: output, threads,
/// baseline and rules.
std::string frames_command_text(const Program& program, int argc, char** argv) {
  constexpr std::string_view kWithValue[] = {"-o",         "--out",   "--threads",
                                             "--baseline", "--rules", "--shard"};
  constexpr std::string_view kFlags[] = {"--json", "--approve", "--resume"};
  std::string text = program.name;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i], name = word.substr(0, word.find('='));
    if (std::ranges::find(kFlags, word) != std::end(kFlags)) continue;
    if (std::ranges::find(kWithValue, name) != std::end(kWithValue)) {
      if (name == word) ++i;
    } else if (!word.starts_with("-o")) {
      text.append(1, ' ').append(shell_word(argv[i]));
    }
  }
  return text;
}

// Returns the innermost selected subcommand: for `synth stairs`, the app of `stairs`.
const CLI::App* innermost(const CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return app;
}

std::vector<std::string> subcommand_names(const CLI::App* app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app->get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

/// Returns the path of a command, e.g. "report merge".
std::string path_of(const CLI::App& app, const CLI::App& command) {
  if (&command == &app) return {};
  const std::string parent = path_of(app, *command.get_parent());
  return parent.empty() ? command.get_name() : parent + " " + command.get_name();
}

/// Returns e.g. "segment needs -o DIR: output folder".
std::string missing(const std::string& command, const CLI::Option& option) {
  const std::string name =
      option.get_snames().empty() ? option.get_name() : "-" + option.get_snames()[0];
  const std::string type = option.get_type_name();
  return fmt::format("{} needs {}{}{}: {}", command, name, type.empty() ? "" : " ", type,
                     clause_of(option.get_description()));
}

/// Whether CLI11's message is about this option: it begins with the option's name.
bool is_named(const CLI::Option& option, const std::string& message) {
  return option.get_type_size() > 0 && message.starts_with(option.get_name() + ": ");
}

// Returns a one-line message for a CLI11 error, with a suggestion for a misspelled name.
std::string message_of(const Program& program, const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = innermost(&app);
  const std::vector<std::string> extras = app.remaining(true);
  if (extras.empty()) {
    for (const CLI::Option* option : command->get_options())
      if (error.get_name() == "RequiredError" && option->get_required() && option->count() == 0)
        return missing(path_of(app, *command), *option);
    for (const CLI::Option* option : command->get_options())
      if (error.get_name() == "ArgumentMismatch" && is_named(*option, error.what()))
        return option->count() > 1 ? option->get_name() + " is specified more than once"
                                   : fmt::format("{} needs a value: {}", option->get_name(),
                                                 option->get_type_name());
    std::string text = error.what();
    return text.substr(0, text.find('\n'));
  }
  const std::string& word = extras.front();
  const bool is_option = word.size() > 1 && word[0] == '-';
  std::vector<std::string> names;
  if (is_option) {
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  } else {
    names = subcommand_names(command);
  }
  const std::string given = word.substr(0, word.find('='));
  const std::string near = nearest_name(given, names);
  const std::string path = path_of(app, *command);
  std::string text = is_option       ? "unknown option '" + given + "'"
                     : names.empty() ? "unexpected argument '" + given + "'"
                                     : "unknown command '" + given + "'";
  const std::string reader = path.empty() && program.alone ? program.alone : path;
  std::error_code ignored;
  if (is_option && !reader.empty() && std::filesystem::exists(word, ignored))
    return fmt::format("{}; to open the file of that name, type: {} {} -- {}", text, program.name,
                       reader, shell_word(word));
  if (!near.empty()) return text + "; did you mean '" + near + "'?";
  constexpr std::size_t kFewNames = 8;
  if (!is_option && !names.empty() && names.size() <= kFewNames)
    return names.size() > 2 ? fmt::format("{}; expected one of {}", text, fmt::join(names, ", "))
                            : fmt::format("{}; expected {}", text, fmt::join(names, " or "));
  return text + "; see " + app.get_name() + (path.empty() ? "" : " ") + path + " --help";
}

Job print_job(const std::string& text) {
  return [text](std::stop_token) {
    fmt::print("{}", text);
    return 0;
  };
}

/// "planescope 0.2.0, commit 1234567", as in reports.
std::string version_text(const Program& program) {
  const report::BuildInfo build = report::build_info();
  const bool has_hash = build.commit.size() == 40;
  return fmt::format("{} {}, commit {}{}", program.name, build.version,
                     has_hash ? build.commit.substr(0, 12) : build.commit,
                     build.modified ? " with uncommitted changes" : "");
}

/// Parses the command line. `--help` and `--version` become jobs that print. Throws Error on
/// invalid usage.
Job parse(const Program& program, int argc, char** argv) {
  CLI::App app(program.about, program.name);
  app.set_version_flag("--version", version_text(program));
  app.formatter(help_format());
  app.get_help_ptr()->description("Print this help and exit");
  app.get_version_ptr()->description("Print version and commit and exit");
  app.require_subcommand(0, 1);  // `help info` is one command, like `info info`
  Line line{command_text(program, argc, argv), frames_command_text(program, argc, argv), {}};
  for (const auto define : program.commands) define(app, line);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    command->group("Commands");
  try {
    const bool is_alone = argc == 1 || (argc == 2 && argv[1] == std::string_view("--"));
    if (is_alone && program.alone)
      app.parse(std::vector<std::string>{program.alone});
    else
      app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    std::ostringstream text;
    app.exit(success, text, text);
    return print_job(text.str());
  } catch (const CLI::ParseError& error) {
    throw Error(message_of(program, app, error));
  }
  if (line.job) return line.job;
  const CLI::App* group = innermost(&app);
  throw Error(fmt::format("{}expected one of {}", group == &app ? "" : group->get_name() + ": ",
                          fmt::join(subcommand_names(group), ", ")));
}

/// "DIR/a: too many levels of symbolic links".
std::string path_problem(const std::filesystem::filesystem_error& error) {
  const std::string second = error.path2().empty() ? "" : " and " + error.path2().string();
  std::string reason = error.code().message();
  reason.replace(0, 1, lower_case(reason.substr(0, 1)));
  return fmt::format("{}{}: {}", error.path1().string(), second, reason);
}

int fail(const std::string& message, int code) {
  print_notice(message);
  return code;
}

}  // namespace

int run_program(const Program& program, int argc, char** argv) {
  set_notice_name(program.name);
  // A closed standard stream would be the next file that is opened, and text would go into it.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", O_RDONLY);  // writing fails, as it should
  keep_freed_memory();
  set_reserve_aside();
  try {
    const Job job = parse(program, argc, argv);
    const Interrupt interrupt;
    const int code = job(interrupt.token());
    if (std::fflush(stdout) != 0) return fail("cannot write to standard output", 2);
    return code;
  } catch (const Cancelled&) {
    return fail("canceled", 130);
  } catch (const Error& error) {
    return fail(error.what(), 2);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(path_problem(error), 2);
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again)  // thread creation failed
      return fail("out of memory: cannot start a thread; reduce --threads", 2);
    if (std::ferror(stdout) != 0)
      return fail(std::string("cannot write to standard output: ") + error.code().message(), 2);
    return fail(std::string("unexpected failure: ") + error.what(), 2);
  } catch (const std::bad_alloc&) {
    return fail(std::string("out of memory; ") + kHowToNeedLessMemory, 2);
  } catch (const std::exception& error) {
    return fail(std::string("unexpected failure: ") + error.what(), 2);
  }
}

}  // namespace planescope::app
