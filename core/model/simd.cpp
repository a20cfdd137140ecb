#include "core/model/simd.hpp"

#include <cstdlib>

#include "core/model/error.hpp"

namespace planescope {
namespace {

Simd widest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return Simd::avx512;
  if (__builtin_cpu_supports("avx2")) return Simd::avx2;
#endif
  return Simd::plain;
}

}  // namespace

Simd best_simd() {
  static const Simd kWidest = widest();
  const char* asked = std::getenv("PLANESCOPE_SIMD");
  if (!asked || !*asked) return kWidest;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512}) {
    if (to_string(simd) != asked) continue;
    if (simd > kWidest)
      throw Error("PLANESCOPE_SIMD is " + to_string(simd) + ", but this processor has only " +
                  to_string(kWidest));
    return simd;
  }
  throw Error("PLANESCOPE_SIMD is '" + std::string(asked) + "', expected plain, avx2 or avx512");
}

std::string to_string(Simd simd) {
  switch (simd) {
    case Simd::avx2:
      return "avx2";
    case Simd::avx512:
      return "avx512";
    case Simd::plain:
      break;
  }
  return "plain";
}

}  // namespace planescope
