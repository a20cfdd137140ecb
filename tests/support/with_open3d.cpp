// Registers Open3D in test programs, as `planescope` does.

#include "core/io/open3d/install.hpp"

namespace {

[[maybe_unused]] const bool installed = (planescope::open3d::install(), true);

}  // namespace
