#include <bit>
#include <cassert>
#include <cstring>

#include "core/base/file_bytes.hpp"
#include "core/recording/cloud_file.hpp"

namespace planescope {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written as it lies in memory");

template <typename T>
void append(std::vector<unsigned char>& out, T value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof(T));
  std::memcpy(out.data() + at, &value, sizeof(T));
}

}  // namespace

void write_ply(const std::filesystem::path& path, const PointSet& set) {
  const std::size_t count = set.points.size();
  const bool has_origin = !set.origin.isZero(0);
  assert(set.rgb.empty() || set.rgb.size() == 3 * count);
  assert(set.label.empty() || set.label.size() == count);
  assert(set.instance.empty() || set.instance.size() == count);

  const std::string scalar = has_origin ? "double" : "float";
  std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + scalar + " " + axis + "\n";
  if (!set.rgb.empty()) {
    for (const char* c : {"red", "green", "blue"})
      header += std::string("property uchar ") + c + "\n";
  }
  if (!set.label.empty()) header += "property uchar label\n";
  if (!set.instance.empty()) header += "property int instance\n";
  header += "end_header\n";

  std::vector<unsigned char> out(header.begin(), header.end());
  out.reserve(out.size() + count * (has_origin ? 32 : 20));
  for (std::size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (has_origin) {
        append(out, set.origin[axis] + static_cast<double>(set.points[i][axis]));
      } else {
        append(out, set.points[i][axis]);
      }
    }
    if (!set.rgb.empty()) out.insert(out.end(), &set.rgb[3 * i], &set.rgb[3 * i] + 3);
    if (!set.label.empty()) append(out, set.label[i]);
    if (!set.instance.empty()) append(out, set.instance[i]);
  }
  write_file_bytes(path, out);
}

}  // namespace planescope
