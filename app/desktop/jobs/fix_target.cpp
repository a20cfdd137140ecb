#include "app/desktop/jobs/fix_target.hpp"

#include <algorithm>
#include <vector>

#include "core/debug/explain/provenance.hpp"
#include "core/labels/wand/wand.hpp"

namespace planescope::desktop {
namespace {

/// Voxels of the surface at one, ascending; empty where there is no plane.
std::vector<std::uint32_t> surface_at(const debug::Run& run,
                                      const labels::LabelGrid& grid,
                                      std::uint32_t voxel) {
  const debug::Subject& subject = *run.subject;
  const auto seed = static_cast<std::uint32_t>(debug::source_of_voxel(subject, voxel));
  const auto surface = labels::grow_plane(grid, nullptr, std::span(&seed, 1), {});
  return surface ? subject.voxels_of_sources(surface->pixels) : std::vector<std::uint32_t>();
}

}  // namespace

debug::FixTarget fix_target(const debug::Run& run, const PointAsked& asked) {
  if (asked.wish == debug::Wish::no_plane)
    return debug::target_of_click(run, asked.voxel, asked.wish);
  const debug::Subject& subject = *run.subject;
  const labels::LabelGrid grid = labels::make_label_grid(subject.frame, subject.prepared.gravity);
  std::vector<std::uint32_t> surface = surface_at(run, grid, asked.voxel);
  if (asked.wish == debug::Wish::joined && asked.with >= 0) {
    const auto other = surface_at(run, grid, static_cast<std::uint32_t>(asked.with));
    std::vector<std::uint32_t> both;
    std::ranges::set_union(surface, other, std::back_inserter(both));
    surface = std::move(both);
  }
  debug::FixTarget target =
      debug::target_of_click(run, asked.voxel, asked.wish, std::move(surface));
  target.with = asked.with;
  return target;
}

}  // namespace planescope::desktop
