#pragma once

// What a run's planes are worth: their outlines at once, room for a foot and stairs a little later.

#include <memory>
#include <string>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// The outlines alone, without fills: they take a few milliseconds. Null where GEOS refuses them.
std::shared_ptr<const render::PlaneScene> outlines_of_run(const debug::Run& run);

/// Everything; of the options, what does not steer the run. Throws Error.
std::shared_ptr<const RunPlanes> planes_of_run(const std::shared_ptr<const RunView>& view,
                                               const planes::PipelineOptions& options);

/// Of options: equal texts, and planes_of_run() tells the same of a run.
std::string planes_key(const planes::PipelineOptions& options);
/// Whether an option is about finished planes, and changes no run.
bool is_about_planes(const planes::OptionInfo& info);

}  // namespace planescope::desktop
