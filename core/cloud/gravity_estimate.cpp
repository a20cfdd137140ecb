#include "core/cloud/gravity.hpp"

namespace planescope {

std::optional<Gravity> estimate_gravity(const Frame&, const GravityOptions&) {
  return std::nullopt;
}

}  // namespace planescope
