#pragma once

// Kinds of calls that can fail, shared by the fault layer and the tests.

#include <array>
#include <string_view>

namespace planescope::faults {

/// The kinds of calls. The layer counts each kind, in this order.
inline constexpr std::array<std::string_view, 14> kKinds = {
    "open",     "read",  "write", "sync",   "rename", "remove", "map",
    "truncate", "mkdir", "list",  "thread", "memory", "egl",    "gl"};

}  // namespace planescope::faults
