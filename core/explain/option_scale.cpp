#include "core/explain/option_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planescope {

double OptionScale::position(double value) const {
  constexpr double kLeast = 1e-4;
  if (is_share()) {
    value = std::clamp(value, kLeast, 1 - kLeast);
    return std::log(value / (1 - value));
  }
  return std::log(std::max(value, kLeast));
}

std::string OptionScale::text_at(double position) const {
  const double e = std::exp(position);
  // Six digits are more than any search resolves, and can be read.
  const double value = std::stod(fmt::format("{:.6g}", is_share() ? e / (1 + e) : e));
  return number_text(info_, value);
}

}  // namespace planescope
