#pragma once

// Growth of times with points, planes, voxels, image size, and threads.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/chain_speed.hpp"

namespace planescope::lab {

struct ScalingCurve {
  std::string name;
  std::vector<double> ms;  // median, by x
  double exponent = 0;     // NaN: too few x to fit one
};
void visit_fields(auto& fields, Same<ScalingCurve> auto& curve) {
  fields("name", curve.name);
  fields("ms", curve.ms);
  fields("exponent", curve.exponent);
}

struct Scaling {
  std::string id;  // points, planes, voxels, images, threads
  std::string title, x_name, note;
  Clock clock = Clock::thread_cpu;
  std::vector<double> x = {};  // ascending
  std::vector<ScalingCurve> curves = {};
};
void visit_fields(auto& fields, Same<Scaling> auto& scaling) {
  fields("id", scaling.id);
  fields("title", scaling.title);
  fields("x_name", scaling.x_name);
  fields("note", scaling.note);
  fields("clock", to_string(scaling.clock));
  fields("x", scaling.x);
  fields("curves", scaling.curves);
}

/// The e of y = c x^e, by least squares of log y over log x; NaN for fewer than two different x.
/// All values must be positive.
double fitted_exponent(std::span<const double> x, std::span<const double> y);

/// The frame with edges `scale` times as long, by the nearest pixel, without color. The field of
/// view stays the same.
Frame scaled_frame(const Frame& frame, double scale);

/// Points: a staircase. Planes: tiles of 50,000 points (both up to the tools' limit). Voxels and
/// image sizes: the subject's first frame; no image sizes for clouds. Threads: all of its frames.
std::vector<Scaling> measure_scaling(const SpeedSubject& subject, const SpeedTools& tools);

}  // namespace planescope::lab
