#pragma once

// Kinds of calls that can fail, shared by the fault layer and the tests.

#include <array>
#include <string_view>

namespace planescope::faults {

/// The kinds of calls. The layer counts each kind, in this order.
inline constexpr std::array<std::string_view, 14> kKinds = {
    "open",     "read",  "write", "sync",   "rename", "remove", "map",
    "truncate", "mkdir", "list",  "thread", "memory", "egl",    "gl"};

/// In place of an errno: the process is killed before the call.
inline constexpr int kKill = -1;

}  // namespace planescope::faults
