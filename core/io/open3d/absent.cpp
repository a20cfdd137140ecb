// Builds without -DPLANESCOPE_OPEN3D=ON.

#include "core/io/open3d/install.hpp"

namespace planescope::open3d {

void install() {}

}  // namespace planescope::open3d
