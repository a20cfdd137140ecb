// The one place where errors become a line on stderr and an exit code:
// 0 fine, 1 a threshold or comparison failed, 2 bad input or usage, 3 rendering failed (the data
// files are written), 130 cancelled.

#include <cstdio>
#include <exception>
#include <string>

#include "app/cli/cli.hpp"
#include "app/cli/interrupt.hpp"
#include "core/io/open3d/install.hpp"
#include "core/model/error.hpp"

namespace {

// One line, whatever a library's message looks like.
int fail(std::string message, int code) {
  for (char& c : message)
    if (c == '\n' || c == '\r') c = ' ';
  std::fprintf(stderr, "planescope: %s\n", message.c_str());
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    planescope::open3d::install();
    const planescope::app::Job job = planescope::app::parse_command_line(argc, argv);
    const planescope::app::Interrupt interrupt;
    const int code = job(interrupt.token());
    if (std::fflush(stdout) != 0) return fail("standard output cannot be written to", 2);
    return code;
  } catch (const planescope::Cancelled&) {
    return fail("cancelled", 130);
  } catch (const planescope::Error& error) {
    return fail(error.what(), 2);
  } catch (const std::exception& error) {
    return fail(std::string("unexpected failure: ") + error.what(), 2);
  }
}
