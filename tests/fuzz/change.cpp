#include "fuzz/change.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace planescope::fuzz {
namespace {

std::ptrdiff_t at(std::size_t place) { return static_cast<std::ptrdiff_t>(place); }

void change_pieces(std::vector<ByteVector>& pieces,
                   std::size_t max,
                   std::minstd_rand& random,
                   const ChangeBytes& change_bytes) {
  const auto any = [&] { return static_cast<std::size_t>(random() % pieces.size()); };
  switch (random() % 8) {
    case 0:
      pieces.push_back(pieces[any()]);
      break;
    case 1:
      pieces.erase(pieces.begin() + at(any()));
      break;
    case 2:
      std::swap(pieces[any()], pieces[any()]);
      break;
    default:
      change_bytes(pieces[any()], max);
  }
}

/// Places begin .. end of the bytes, short ones more often than long ones.
std::pair<std::size_t, std::size_t> any_part(const ByteVector& bytes, std::minstd_rand& random) {
  const std::size_t begin = random() % bytes.size();
  const std::size_t longest = std::size_t{1} << random() % 12;
  return {begin, begin + std::min(bytes.size() - begin, 1 + random() % longest)};
}

void change_once(ByteVector& bytes, std::minstd_rand& random) {
  if (bytes.empty()) bytes.push_back(0);
  const auto [begin, end] = any_part(bytes, random);
  switch (random() % 6) {
    case 0:
      bytes[begin] ^= static_cast<unsigned char>(1 << random() % 8);
      break;
    case 1: {  // a number at one of its ends
      constexpr std::array<unsigned char, 5> kEnds = {0x00, 0x01, 0x7f, 0x80, 0xff};
      const std::size_t width = std::min<std::size_t>(bytes.size() - begin, 1 << random() % 4);
      std::fill_n(bytes.begin() + at(begin), width, kEnds[random() % kEnds.size()]);
      break;
    }
    case 2:
      bytes.erase(bytes.begin() + at(begin), bytes.begin() + at(end));
      break;
    case 3:
      bytes.resize(begin);
      break;
    case 4: {
      const ByteVector part(bytes.begin() + at(begin), bytes.begin() + at(end));
      bytes.insert(bytes.begin() + at(random() % bytes.size()), part.begin(), part.end());
      break;
    }
    default: {
      const ByteVector part(bytes.begin() + at(begin), bytes.begin() + at(end));
      const std::size_t to = random() % (bytes.size() - part.size() + 1);
      std::ranges::copy(part, bytes.begin() + at(to));
    }
  }
}

}  // namespace

ByteVector with_changed_piece(const Target& target,
                              Bytes bytes,
                              std::size_t max,
                              std::minstd_rand& random,
                              const ChangeBytes& change_bytes) {
  try {
    std::vector<ByteVector> pieces = target.split(bytes);
    if (pieces.empty()) return {};
    change_pieces(pieces, max, random, change_bytes);
    ByteVector changed = target.join(pieces);
    return changed.size() <= max ? changed : ByteVector();
  } catch (const std::exception&) {
    return {};
  }
}

void change_at_random(ByteVector& bytes, std::size_t max, std::minstd_rand& random) {
  constexpr unsigned kMostChanges = 4;
  for (unsigned left = 1 + random() % kMostChanges; left > 0; --left) change_once(bytes, random);
  bytes.resize(std::min(bytes.size(), max));
}

}  // namespace planescope::fuzz
