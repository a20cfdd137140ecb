// Explains why a pixel has no plane: step_through_trace RECORDING [PICTURE.png]
// Prints the events that concern the pixel in the center of the first frame.

#include <cstdio>
#include <planescope/io.hpp>
#include <planescope/render.hpp>

int main(int argc, char** argv) try {
  if (argc < 2) throw planescope::Error("expected RECORDING [PICTURE.png]");
  const planescope::Recording recording(argv[1]);
  const planescope::Frame frame = recording[0];
  const planescope::Trace trace = planescope::Segmenter().trace(frame);

  const planescope::Camera camera = frame.depth().camera;
  const std::size_t middle =
      frame.is_cloud() ? frame.size() / 2 : (camera.height / 2) * camera.width + camera.width / 2;
  int before = -1, shown = 0;
  for (int step = 1; step <= trace.steps(); ++step) {
    const int plane = trace.plane_of(step, middle);
    if (plane == before) continue;
    std::printf("step %d: %s\n", step, trace.describe(step).c_str());
    before = plane;
    shown = step;
  }
  const planescope::Result result = trace.result();
  std::printf("%d steps, %zu nodes; in the end it is in plane %d\n", trace.steps(),
              trace.nodes().size(), result.plane_of()[middle]);

  if (argc > 2) planescope::write_png(argv[2], planescope::Renderer().draw(trace, shown));
  return 0;
} catch (const planescope::Error& error) {
  std::fprintf(stderr, "step_through_trace: %s\n", error.what());
  return 2;
}
