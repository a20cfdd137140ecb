// One program for all targets: PLANESCOPE_FUZZ_TARGET says which.

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "core/model/file_bytes.hpp"
#include "fuzz/change.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max);

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

void change_bytes(ByteVector& bytes, std::size_t max) {
  const std::size_t size = bytes.size();
  bytes.resize(std::max(max, size + 1));
  bytes.resize(LLVMFuzzerMutate(bytes.data(), size, bytes.size()));
}

/// Size of the changed file in `data`; 0 where there is none.
std::size_t mutate_pieces(std::uint8_t* data, std::size_t size, std::size_t max, unsigned seed) {
  std::minstd_rand random(seed);
  const ByteVector bytes = with_changed_piece(target(), {data, size}, max, random, change_bytes);
  if (!bytes.empty()) std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}

}  // namespace
}  // namespace planescope::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  planescope::fuzz::target();
  // Far below what a run may take: memory that grows beyond the limit is noticed.
  planescope::set_read_limit_bytes(std::uint64_t{64} << 20);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                               std::size_t size,
                                               std::size_t max,
                                               unsigned seed) {
  using namespace planescope::fuzz;
  // Half of the changes are of bytes: lengths, checksums and places are to be wrong too.
  if (target().split && seed % 2 == 0)
    if (const std::size_t changed = mutate_pieces(data, size, max, seed / 2)) return changed;
  return LLVMFuzzerMutate(data, size, max);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  planescope::fuzz::read(planescope::fuzz::target(), {data, size});
  return 0;
}
