#pragma once

// Arguments of actions, from text.

#include <string>
#include <vector>

namespace planescope::desktop {

/// Throw Error naming the action and what was expected.
int whole_argument(const std::string& action, const std::string& text, int low, int high);
double number_argument(const std::string& action, const std::string& text);
/// "12.5,3,7" as exactly `count` numbers.
std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count);
/// The index of `text` among `names`.
int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names);

}  // namespace planescope::desktop
