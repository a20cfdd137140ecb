/* Finds planes in a depth image in meters, in C99: segment_depth_c
 * The image is synthetic: a camera 30 cm above a floor, and 1 m ahead a step of 15 cm. */

#include <planescope/planescope.h>
#include <stdio.h>
#include <stdlib.h>

static int fail(void) {
  fprintf(stderr, "segment_depth_c: %s\n", planescope_last_error());
  return 2;
}

int main(void) {
  const planescope_option options[] = {{"profile", "refined"}, {"max_range_m", "3"}};
  const double gravity[3] = {0, 1, 0}; /* the camera is level, so gravity is its y axis */
  const planescope_camera camera = {.width = 424, .height = 240, .fx = 300, .fy = 300, .cx = 211.5, .cy = 119.5};
  float* meters = malloc(sizeof(float) * 424 * 240);
  planescope_segmenter* segmenter;
  planescope_result* result;
  size_t i, on_planes = 0;

  for (i = 0; i < 424 * 240; ++i) {
    const double down = ((double)(i / 424) - camera.cy) / camera.fy; /* drop of the ray per meter ahead */
    meters[i] = (float)(down > 0.3 ? 0.30 / down : down > 0.15 ? 1.0 : down > 0.05 ? 0.15 / down : 0);
  }
  segmenter = planescope_segmenter_create(options, 2, 1);
  if (!segmenter) return fail();
  result = planescope_segment(
      segmenter, &(planescope_depth){.meters = meters, .camera = camera, .gravity = gravity});
  if (!result) return fail();

  for (i = 0; i < planescope_result_plane_count(result); ++i) {
    planescope_plane plane;
    if (planescope_result_plane(result, i, &plane) != 0) return fail();
    printf("plane %d: %s, %.0f deg, %.2f m2, %.0f mm above the floor\n", (int)plane.id,
           plane.label == PLANESCOPE_HORIZONTAL ? "h" : "v", plane.tilt_deg, plane.area_m2, plane.height_m * 1e3);
  }
  for (i = 0; i < 424 * 240; ++i) on_planes += planescope_result_labels(result)[i] > 0;
  printf("%lu of %d pixels on planes, planescope %s\n", (unsigned long)on_planes, 424 * 240, planescope_version());

  planescope_result_free(result);
  planescope_segmenter_free(segmenter);
  free(meters);
  return 0;
}
