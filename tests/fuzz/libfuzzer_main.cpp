// One program for all targets; PLANESCOPE_FUZZ_TARGET selects one.

#include <cstdlib>
#include <iostream>

#include "core/model/file_bytes.hpp"
#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {
namespace {

Target chosen_target() {
  const char* name = std::getenv("PLANESCOPE_FUZZ_TARGET");
  for (const Target& target : all_targets())
    if (name && target.name == std::string(name)) return target;
  std::cerr << "PLANESCOPE_FUZZ_TARGET: expected one of";
  for (const Target& target : all_targets()) std::cerr << ' ' << target.name;
  std::cerr << '\n';
  std::exit(2);
}

const Target& target() {
  static const Target chosen = chosen_target();
  return chosen;
}

}  // namespace
}  // namespace planescope::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  planescope::fuzz::target();
  // Far below the memory limit of a run, so that excess memory is noticed.
  planescope::set_read_limit_bytes(std::uint64_t{64} << 20);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  planescope::fuzz::read(planescope::fuzz::target(), {data, size});
  return 0;
}
