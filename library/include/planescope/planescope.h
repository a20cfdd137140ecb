/* C interface of the library: planes in depth images, for programs that cannot use core.hpp. C99
 * and later.
 *
 * Lengths are meters, angles degrees. The sensor's frame is that of cameras: x right, y down, z
 * forward. The world frame has z up and the sensor at its origin. A function that fails returns
 * NULL or -1, and planescope_last_error() returns the reason in one line. A segmenter may be used
 * from several threads at once. */

#ifndef PLANESCOPE_PLANESCOPE_H
#define PLANESCOPE_PLANESCOPE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PLANESCOPE_C_API __attribute__((visibility("default")))

/** Options and a classifier, ready to segment frames. */
typedef struct planescope_segmenter planescope_segmenter;
/** The planes of one frame. */
typedef struct planescope_result planescope_result;

/** An option by its name; `planescope options` lists them. */
typedef struct planescope_option {
  const char* name;
  const char* value;
} planescope_option;

enum planescope_distortion {
  PLANESCOPE_NO_DISTORTION = 0,
  PLANESCOPE_BROWN_CONRADY = 1, /**< as in OpenCV */
  PLANESCOPE_INVERSE_BROWN_CONRADY = 2
};

/** A pinhole camera: pixel (u, v) looks along ((u - cx) / fx, (v - cy) / fy, 1). */
typedef struct planescope_camera {
  int32_t width, height;  /**< [px] */
  double fx, fy, cx, cy;  /**< [px] */
  int32_t distortion;     /**< of enum planescope_distortion */
  double coefficients[5]; /**< k1 k2 p1 p2 k3 */
} planescope_camera;

/** A depth image. Exactly one of `counts` and `meters` is set; it is only read during the call. */
typedef struct planescope_depth {
  const uint16_t* counts; /**< [height * width]; 0: not measured */
  const float* meters;    /**< [height * width]; NaN, infinite, 0 or less: not measured. Stored as
                             counts of 0.2 or 1 mm; beyond 65.5 m: an outlier */
  double unit_m;          /**< meters per count of `counts`; 0 means 0.001 */
  size_t row_stride;      /**< elements from one row to the next; 0: the width */
  planescope_camera camera;
  const double* gravity;  /**< [3], in the sensor's frame, of any length; NULL: estimated */
} planescope_depth;

enum planescope_label {
  PLANESCOPE_UNKNOWN = 0,
  PLANESCOPE_HORIZONTAL = 1,
  PLANESCOPE_VERTICAL = 2
};

/** A plane in the world frame. */
typedef struct planescope_plane {
  int32_t id;    /**< from 1 */
  int32_t label; /**< of enum planescope_label: horizontal up to 45 degrees of tilt */
  double normal[3];
  double centroid[3];
  double offset_m; /**< normal . x for points x of the plane */
  double tilt_deg; /**< 0: floor, 90: wall; NaN: gravity is unknown */
  double rms_m;    /**< RMS distance of its points */
  double area_m2;  /**< of its outline, without holes */
  double height_m; /**< above the floor; NaN: not level */
  uint64_t points; /**< pixels */
} planescope_plane;

/** Version of the loaded library, "0.2.0". */
PLANESCOPE_C_API const char* planescope_version(void);
/** Reason why the last failed call on this thread failed; "" before the first. Valid until the next
 * failure. */
PLANESCOPE_C_API const char* planescope_last_error(void);

/** `options` are set in order, so `profile` comes first; NULL with `count` 0 for the defaults.
 * `threads`: 1 or more, for one frame; results do not depend on it. NULL on failure. */
PLANESCOPE_C_API planescope_segmenter* planescope_segmenter_create(const planescope_option* options,
                                                                   size_t count,
                                                                   int32_t threads);
/** NULL is ignored. */
PLANESCOPE_C_API void planescope_segmenter_free(planescope_segmenter* segmenter);

/** Finds the planes of a frame. NULL on failure. */
PLANESCOPE_C_API planescope_result* planescope_segment(const planescope_segmenter* segmenter,
                                                       const planescope_depth* depth);
/** NULL is ignored. */
PLANESCOPE_C_API void planescope_result_free(planescope_result* result);

/** Number of planes. */
PLANESCOPE_C_API size_t planescope_result_plane_count(const planescope_result* result);
/** Writes plane `index`, from 0, to `plane`. 0, or -1 on failure. */
PLANESCOPE_C_API int32_t planescope_result_plane(const planescope_result* result,
                                                 size_t index,
                                                 planescope_plane* plane);
/** Plane id of each pixel, [height * width], 0: no plane. Valid until the result is freed. */
PLANESCOPE_C_API const int32_t* planescope_result_labels(const planescope_result* result);
/** Writes the pose of the sensor in the world frame to `transform`: 4x4, row by row. */
PLANESCOPE_C_API void planescope_result_pose(const planescope_result* result, double transform[16]);
/** Everything as JSON, as `planescope segment` writes planes.json: outlines, stairs, footholds.
 * Valid until the result is freed. */
PLANESCOPE_C_API const char* planescope_result_json(const planescope_result* result);

#ifdef __cplusplus
}
#endif

#endif /* PLANESCOPE_PLANESCOPE_H */
