#include <cmath>
#include <cstdio>

#include "core/labels/exchange/exchange_files.hpp"

namespace planescope::labels {

void check_count(std::uint64_t points, const std::string& where) {
  if (points > kMaxLabelledPoints)
    throw Error(where + ": " + std::to_string(points) + " points, expected at most " +
                std::to_string(kMaxLabelledPoints));
}

std::string printable(std::string_view text) {
  std::string result(text.substr(0, 60));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return result;
}

template <typename T>
std::vector<T> whole_numbers(std::span<const double> values,
                             double low,
                             double high,
                             const std::string& where) {
  std::vector<T> whole(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    if (!(value >= low && value <= high) || value != std::floor(value)) {
      char text[128];
      std::snprintf(text, sizeof(text),
                    ": %g at place %zu, expected a whole number of %.0f to %.0f", value, i, low,
                    high);
      throw Error(where + text);
    }
    whole[i] = static_cast<T>(value);
  }
  return whole;
}
template std::vector<std::uint8_t> whole_numbers(std::span<const double>,
                                                 double,
                                                 double,
                                                 const std::string&);
template std::vector<std::uint16_t> whole_numbers(std::span<const double>,
                                                  double,
                                                  double,
                                                  const std::string&);
template std::vector<std::int32_t> whole_numbers(std::span<const double>,
                                                 double,
                                                 double,
                                                 const std::string&);

std::vector<std::int32_t> instances_of(std::span<const double> values, const std::string& where) {
  return whole_numbers<std::int32_t>(values, 0, kPlaneIgnore, where + ": plane id");
}

std::vector<std::uint8_t> classes_of(std::span<const double> values, const std::string& where) {
  const auto classes = whole_numbers<std::uint8_t>(values, 0, kHvIgnore, where + ": class");
  for (std::size_t i = 0; i < classes.size(); ++i)
    if (classes[i] > 2 && classes[i] != kHvIgnore)
      throw Error(where + ": class " + std::to_string(classes[i]) + " at place " +
                  std::to_string(i) + ", expected 0 (unknown), 1 (h), 2 (v) or 255 (ignore)");
  return classes;
}

}  // namespace planescope::labels
