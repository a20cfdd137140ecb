#include "core/report/data/build_info.hpp"

#include "planescope_build_info.h"  // written by cmake/BuildInfo.cmake at every build

namespace planescope::report {

BuildInfo build_info() {
  return {PLANESCOPE_BUILD_VERSION, PLANESCOPE_BUILD_COMMIT, PLANESCOPE_BUILD_MODIFIED};
}

}  // namespace planescope::report
