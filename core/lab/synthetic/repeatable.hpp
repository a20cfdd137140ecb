#pragma once

// Random numbers, sines and rotations that are bitwise equal on every machine, which the
// distributions of <random> and the functions of libm do not guarantee. Random numbers are
// counter-based: a value depends only on its seed, stream and index, so images can be filled in any
// order (random.hpp has a plain sequence).

#include <cmath>
#include <cstdint>

#include "core/model/types.hpp"

namespace planescope::lab {

/// Splitmix64's finalizer: maps 64 bits to 64 well-mixed bits.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

constexpr std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return mix_bits(mix_bits(mix_bits(seed) ^ stream) ^ index);
}

/// Uniform in [0, 1).
constexpr double random_uniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(random_bits(seed, stream, index) >> 11) * 0x1p-53;
}

/// Mean 0, standard deviation 1, nearly normal: the sum of eight 16-bit uniforms (Irwin-Hall),
/// bounded by +-4.9.
constexpr double random_normal(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  std::uint64_t sum = 0;
  std::uint64_t bits = random_bits(seed, stream, index);
  for (int word = 0; word < 2; ++word) {
    for (int shift = 0; shift < 64; shift += 16) sum += (bits >> shift) & 0xffff;
    bits = mix_bits(bits);
  }
  constexpr double kMean = 8 * 32767.5;
  constexpr double kInverseDeviation = 1.0 / 53509.91992145;  // sqrt(8 (65536^2 - 1) / 12)
  return (static_cast<double>(sum) - kMean) * kInverseDeviation;
}

/// Results of libm may differ in the last bit between machines, which would change pixels. Rounded
/// to 2^-40 (1e-12), they are the same everywhere.
inline double repeatable(double x) { return std::round(x * 0x1p40) * 0x1p-40; }
inline double sin_deg(double degrees) { return repeatable(std::sin(degrees * M_PI / 180)); }
inline double cos_deg(double degrees) { return repeatable(std::cos(degrees * M_PI / 180)); }

/// Rotation by `angle_deg` about a unit axis (Rodrigues).
inline Mat3d rotation(const Vec3d& axis, double angle_deg) {
  Mat3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Mat3d::Identity() + sin_deg(angle_deg) * cross + (1 - cos_deg(angle_deg)) * cross * cross;
}

}  // namespace planescope::lab
