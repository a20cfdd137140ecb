#include "core/model/read_limit.hpp"

#include <fmt/format.h>

#include <atomic>

#include "core/model/error.hpp"

namespace planescope {
namespace {

constexpr double kMiB = 1 << 20;

std::atomic<std::uint64_t> g_limit_bytes{std::uint64_t{512} << 20};

}  // namespace

std::uint64_t read_limit_bytes() { return g_limit_bytes; }
void set_read_limit_bytes(std::uint64_t bytes) { g_limit_bytes = bytes; }

void expect_within_read_limit(double bytes, const std::string& what) {
  const auto limit = static_cast<double>(read_limit_bytes());
  if (bytes > limit)
    throw Error(
        fmt::format("{} would take {:.0f} MiB in memory, expected at most {:.0f}: see "
                    "--read-limit",
                    what, bytes / kMiB, limit / kMiB));
}

}  // namespace planescope
