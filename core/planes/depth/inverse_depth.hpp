#pragma once

// Planes in inverse depth. With rho = 1 / z [1/m], a plane is affine in pixel coordinates, and the
// noise of stereo and structured-light cameras is independent of distance. Ten sums describe a set
// of pixels. Sums are additive, so fitting a union needs no access to the pixels.

#include <algorithm>
#include <cstdint>
#include <vector>

namespace planescope::planes {

/// rho of every pixel in raster order [1/m]; 0 if unmeasured or out of range.
struct DepthImage {
  int width = 0, height = 0;
  double unit_m = 0;       // size of one depth count; 0: depth is not quantized
  std::vector<float> rho;  // [1/m]

  std::size_t pixels() const { return rho.size(); }
  double u(int x) const { return x - 0.5 * (width - 1); }  // [px] relative to the image center
  double v(int y) const { return y - 0.5 * (height - 1); }
};

/// rho = a u + b v + c, with u and v relative to the image center.
struct InversePlane {
  double a = 0, b = 0;  // [1/m per px]
  double c = 0;         // [1/m]
  double sse = 0;       // sum of squared residuals of the fitted pixels [1/m^2]

  double at(double u, double v) const { return a * u + b * v + c; }
};

/// Sums over a set of pixels; they define its least-squares plane.
struct PixelMoments {
  double n = 0, u = 0, v = 0, r = 0;
  double uu = 0, uv = 0, vv = 0, ur = 0, vr = 0, rr = 0;

  void add(double x, double y, double rho) {
    n += 1, u += x, v += y, r += rho;
    uu += x * x, uv += x * y, vv += y * y, ur += x * rho, vr += y * rho, rr += rho * rho;
  }
  void remove(double x, double y, double rho) {
    n -= 1, u -= x, v -= y, r -= rho;
    uu -= x * x, uv -= x * y, vv -= y * y, ur -= x * rho, vr -= y * rho, rr -= rho * rho;
  }
  PixelMoments& operator+=(const PixelMoments& o) {
    n += o.n, u += o.u, v += o.v, r += o.r;
    uu += o.uu, uv += o.uv, vv += o.vv, ur += o.ur, vr += o.vr, rr += o.rr;
    return *this;
  }
  PixelMoments& operator-=(const PixelMoments& o) {
    n -= o.n, u -= o.u, v -= o.v, r -= o.r;
    uu -= o.uu, uv -= o.uv, vv -= o.vv, ur -= o.ur, vr -= o.vr, rr -= o.rr;
    return *this;
  }
  /// Sum of squared residuals about any plane [1/m^2].
  double sse_about(const InversePlane& p) const {
    return std::max(0.0, rr - 2 * (p.a * ur + p.b * vr + p.c * r) + p.a * p.a * uu +
                             p.b * p.b * vv + p.c * p.c * n +
                             2 * (p.a * p.b * uv + p.a * p.c * u + p.b * p.c * v));
  }
  /// Least squares in rho; slopes are zero if the pixels are collinear.
  InversePlane fit() const {
    const double mu = u / n, mv = v / n, mr = r / n;
    const double A = uu - u * mu, B = uv - u * mv, C = vv - v * mv;
    const double D = ur - u * mr, E = vr - v * mr, F = rr - r * mr;
    const double det = A * C - B * B;
    if (det < 1e-9 * (A + C) * (A + C) + 1e-18) return {0, 0, mr, std::max(0.0, F)};
    const double a = (D * C - E * B) / det, b = (A * E - B * D) / det;
    return {a, b, mr - a * mu - b * mv, std::max(0.0, F - a * D - b * E)};
  }
};

/// A plane from another frame, at its expected position in this depth image.
struct KnownPlane {
  int id = 0;  // PlaneRegion::known of the resulting plane
  InversePlane plane;
  std::vector<std::uint32_t> pixels;  // pixels where it is expected
  double slack_m = 0;                 // tolerance of the expected position along z
};

/// A known plane explained equally well by a larger known plane; both as ids.
struct KnownCover {
  int covered = 0, by = 0;
};

}  // namespace planescope::planes
