// Label operations that the user waits for, on a frame of 640 x 480: each must take well under 16
// ms on one core.

#include <benchmark/benchmark.h>

#include <array>

#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/labels/edit/edit.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/edit/selection.hpp"
#include "core/labels/wand/wand.hpp"

namespace planescope {
namespace {

struct Fixture {
  Frame frame;
  FrameLabels truth;
  labels::LabelGrid grid;
  std::uint32_t on_floor = 0;
  labels::PixelSet stroke;
  labels::SpaceView view;
};

const Fixture& fixture() {
  static const Fixture made = [] {
    Fixture f;
    const lab::Scene scene = lab::make_scene("boxes", 1);
    f.frame = lab::render_scene(scene, scene.camera, lab::D435Model{}, 1, &f.truth);
    f.grid = labels::make_label_grid(f.frame, f.truth.gravity);
    f.on_floor = 440 * 640 + 320;
    const labels::DrawnShape shape{labels::DrawnShape::Kind::stroke, {{100, 400}, {500, 420}}, 40};
    f.stroke = labels::pixels_on_image(f.grid, shape);
    f.view.width = 1400;
    f.view.height = 900;
    f.view.px_per_m = 900;
    f.view.clip_from_sensor << 9 / 7.0f, 0, 0, 0, 0, -2, 0, 0, 0, 0, 1, -0.1f, 0, 0, 1, 0;
    return f;
  }();
  return made;
}

void grid(benchmark::State& state) {
  const Fixture& f = fixture();
  for (auto _ : state) benchmark::DoNotOptimize(labels::make_label_grid(f.frame, f.truth.gravity));
}

void brush(benchmark::State& state) {
  const Fixture& f = fixture();
  for (auto _ : state) {
    labels::LabelDraft draft(f.truth);
    labels::paint(draft, f.grid, f.stroke, {1}, labels::PaintMode::over);
    labels::fit_planes(draft, f.grid);
    benchmark::DoNotOptimize(draft.edit(0, "Brush P1"));
  }
}

void wand_on_the_floor(benchmark::State& state) {
  const Fixture& f = fixture();
  for (auto _ : state)
    benchmark::DoNotOptimize(labels::grow_plane(f.grid, nullptr, std::array{f.on_floor}, {}));
}

void see_in_space(benchmark::State& state) {
  const Fixture& f = fixture();
  for (auto _ : state) benchmark::DoNotOptimize(labels::see(f.grid, f.view));
}

void select_in_space(benchmark::State& state) {
  const labels::SeenPoints seen = labels::see(fixture().grid, fixture().view);
  const labels::DrawnShape shape{labels::DrawnShape::Kind::stroke, {{200, 400}, {900, 500}}, 60};
  for (auto _ : state) benchmark::DoNotOptimize(labels::points_in_space(seen, shape, false));
}

BENCHMARK(grid)->Unit(benchmark::kMillisecond);
BENCHMARK(brush)->Unit(benchmark::kMillisecond);
BENCHMARK(wand_on_the_floor)->Unit(benchmark::kMillisecond);
BENCHMARK(see_in_space)->Unit(benchmark::kMillisecond);
BENCHMARK(select_in_space)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace planescope

BENCHMARK_MAIN();
