#pragma once

#include <functional>
#include <span>
#include <vector>

namespace planescope::lab {

/// Wall-clock milliseconds of every contestant, [contestants][rounds]. In each round each of them
/// runs once, so that all share what the machine was busy with; who begins changes from round to
/// round, and a first round is not counted. `before()` is called before each turn and not counted;
/// `body(contestant, round)`.
std::vector<std::vector<double>> interleaved_ms(std::size_t contestants,
                                                int rounds,
                                                const std::function<void()>& before,
                                                const std::function<void(std::size_t, int)>& body);

}  // namespace planescope::lab
