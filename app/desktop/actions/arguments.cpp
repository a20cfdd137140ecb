#include "app/desktop/actions/arguments.hpp"

#include <fmt/format.h>

#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {

int whole_argument(const std::string& action, const std::string& text, int low, int high) {
  const int value = parse_integer(text, "action " + action);
  if (value < low || value > high)
    throw Error(high < low ? fmt::format("action {}: there is no {} to choose, none is there",
                                         action, value)
                           : fmt::format("action {}: {} is out of range, expected {} to {}", action,
                                         value, low, high));
  return value;
}

double number_argument(const std::string& action, const std::string& text) {
  return parse_number(text, "action " + action);
}

std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ','))
    numbers.push_back(parse_number(part, "action " + action));
  if (numbers.size() != count)
    throw Error(fmt::format("action {}: '{}' has {} numbers, expected {}", action, text,
                            numbers.size(), count));
  return numbers;
}

int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return static_cast<int>(i);
  throw Error(fmt::format("action {}: '{}' is unknown, expected {}", action, text,
                          fmt::join(names, " or ")));
}

}  // namespace planescope::desktop
