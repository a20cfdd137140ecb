// In test programs that have what `planescope` has of Open3D.

#include "core/io/open3d/install.hpp"

namespace {

[[maybe_unused]] const bool installed = (planescope::open3d::install(), true);

}  // namespace
