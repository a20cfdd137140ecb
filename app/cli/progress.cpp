#include "app/cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace planescope::app {

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(std::max(1, total)), visible_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void Progress::show(int done, const std::string& now) {
  if (!visible_) return;
  constexpr int kWidth = 28;
  const int filled = std::clamp(done * kWidth / total_, 0, kWidth);
  fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {}/{}  {}", what_, "", filled, "",
             kWidth - filled, done, total_, now);
  std::fflush(stderr);
}

void Progress::print(const std::string& line) {
  fmt::print(stderr, "{}{}\n", visible_ ? "\r\033[K" : "", line);
}

}  // namespace planescope::app
