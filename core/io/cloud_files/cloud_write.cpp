#include <bit>
#include <cassert>
#include <cstring>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

static_assert(std::endian::native == std::endian::little,
              "clouds are written as they lie in memory");

template <typename T>
void append(std::vector<unsigned char>& out, T value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof(T));
  std::memcpy(out.data() + at, &value, sizeof(T));
}

bool is_far(const PointSet& set) { return !set.origin.isZero(0); }

void check_sizes([[maybe_unused]] const PointSet& set,
                 [[maybe_unused]] std::span<const IntField> more) {
  [[maybe_unused]] const std::size_t count = set.points.size();
  assert(set.rgb.empty() || set.rgb.size() == 3 * count);
  assert(set.label.empty() || set.label.size() == count);
  assert(set.instance.empty() || set.instance.size() == count);
  for ([[maybe_unused]] const IntField& field : more) assert(field.values.size() == count);
}

void append_point(std::vector<unsigned char>& out, const PointSet& set, std::size_t i) {
  for (int axis = 0; axis < 3; ++axis) {
    if (is_far(set)) {
      append(out, set.origin[axis] + static_cast<double>(set.points[i][axis]));
    } else {
      append(out, set.points[i][axis]);
    }
  }
}

void append_labels(std::vector<unsigned char>& out,
                   const PointSet& set,
                   std::span<const IntField> more,
                   std::size_t i) {
  if (!set.label.empty()) append(out, set.label[i]);
  if (!set.instance.empty()) append(out, set.instance[i]);
  for (const IntField& field : more) append(out, field.values[i]);
}

std::string ply_header(const PointSet& set, std::span<const IntField> more) {
  const std::string scalar = is_far(set) ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(set.points.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + scalar + " " + axis + "\n";
  if (!set.rgb.empty()) {
    for (const char* c : {"red", "green", "blue"})
      header += std::string("property uchar ") + c + "\n";
  }
  if (!set.label.empty()) header += "property uchar label\n";
  if (!set.instance.empty()) header += "property int instance\n";
  for (const IntField& field : more) header += "property int " + field.name + "\n";
  return header + "end_header\n";
}

std::string pcd_header(const PointSet& set, std::span<const IntField> more) {
  std::string names, sizes, types, counts;
  const auto field = [&](const std::string& name, const char* size, const char* type) {
    names += " " + name;
    sizes += std::string(" ") + size;
    types += std::string(" ") + type;
    counts += " 1";
  };
  for (const char* axis : {"x", "y", "z"}) field(axis, is_far(set) ? "8" : "4", "F");
  if (!set.rgb.empty()) field("rgb", "4", "U");
  if (!set.label.empty()) field("label", "1", "U");
  if (!set.instance.empty()) field("instance", "4", "I");
  for (const IntField& extra : more) field(extra.name, "4", "I");
  const std::string count = std::to_string(set.points.size());
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" + names + "\nSIZE" +
         sizes + "\nTYPE" + types + "\nCOUNT" + counts + "\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
}

}  // namespace

std::vector<unsigned char> ply_bytes(const PointSet& set, std::span<const IntField> more) {
  check_sizes(set, more);
  const std::string header = ply_header(set, more);
  std::vector<unsigned char> out(header.begin(), header.end());
  out.reserve(out.size() + set.points.size() * ((is_far(set) ? 32 : 20) + 4 * more.size()));
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    append_point(out, set, i);
    if (!set.rgb.empty()) out.insert(out.end(), &set.rgb[3 * i], &set.rgb[3 * i] + 3);
    append_labels(out, set, more, i);
  }
  return out;
}

void write_ply(const std::filesystem::path& path, const PointSet& set) {
  write_file_bytes(path, ply_bytes(set));
}

std::vector<unsigned char> pcd_bytes(const PointSet& set, std::span<const IntField> more) {
  check_sizes(set, more);
  const std::string header = pcd_header(set, more);
  std::vector<unsigned char> out(header.begin(), header.end());
  out.reserve(out.size() + set.points.size() * ((is_far(set) ? 33 : 21) + 4 * more.size()));
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    append_point(out, set, i);
    if (!set.rgb.empty()) {
      const std::uint8_t* rgb = &set.rgb[3 * i];
      append(out, std::uint32_t{rgb[0]} << 16 | std::uint32_t{rgb[1]} << 8 | rgb[2]);
    }
    append_labels(out, set, more, i);
  }
  return out;
}

}  // namespace planescope::io
