#pragma once

#include <string>

namespace planescope {

/// Instruction sets that the hot loops are compiled for, each giving the same bits.
enum class Simd { plain, avx2, avx512 };

/// The widest that this processor runs, or less where PLANESCOPE_SIMD=plain|avx2|avx512 is in the
/// environment. Throws Error where that names none of them or more than the processor has.
Simd best_simd();
std::string to_string(Simd simd);

}  // namespace planescope
