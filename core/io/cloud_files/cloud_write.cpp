#include <bit>
#include <cassert>
#include <cstring>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

static_assert(std::endian::native == std::endian::little,
              "clouds are written as they lie in memory");

/// Writes values one behind the other into what was made large enough.
class Packer {
 public:
  explicit Packer(unsigned char* at) : at_(at) {}

  template <typename T>
  void append(T value) {
    std::memcpy(at_, &value, sizeof(T));
    at_ += sizeof(T);
  }

 private:
  unsigned char* at_;
};

bool is_far(const PointSet& set) { return !set.origin.isZero(0); }

void check_sizes([[maybe_unused]] const PointSet& set,
                 [[maybe_unused]] std::span<const IntField> more) {
  [[maybe_unused]] const std::size_t count = set.points.size();
  assert(set.rgb.empty() || set.rgb.size() == 3 * count);
  assert(set.label.empty() || set.label.size() == count);
  assert(set.instance.empty() || set.instance.size() == count);
  for ([[maybe_unused]] const IntField& field : more) assert(field.values.size() == count);
}

void append_point(Packer& out, const PointSet& set, bool far, std::size_t i) {
  for (int axis = 0; axis < 3; ++axis) {
    if (far)
      out.append(set.origin[axis] + static_cast<double>(set.points[i][axis]));
    else
      out.append(set.points[i][axis]);
  }
}

void append_labels(Packer& out,
                   const PointSet& set,
                   std::span<const IntField> more,
                   std::size_t i) {
  if (!set.label.empty()) out.append(set.label[i]);
  if (!set.instance.empty()) out.append(set.instance[i]);
  for (const IntField& field : more) out.append(field.values[i]);
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

/// `header`, and behind it `rgb_bytes` of colour where there is any, and all else, of each point.
template <typename AppendColor>
std::vector<unsigned char> bytes_of(const std::string& header,
                                    const PointSet& set,
                                    std::span<const IntField> more,
                                    std::size_t rgb_bytes,
                                    const AppendColor& append_color) {
  check_sizes(set, more);
  const bool far = is_far(set);
  const std::size_t point_bytes = (far ? 24 : 12) + (set.rgb.empty() ? 0 : rgb_bytes) +
                                  (set.label.empty() ? 0 : 1) + (set.instance.empty() ? 0 : 4) +
                                  4 * more.size();
  std::vector<unsigned char> bytes(header.size() + set.points.size() * point_bytes);
  std::memcpy(bytes.data(), header.data(), header.size());
  Packer out(bytes.data() + header.size());
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    append_point(out, set, far, i);
    if (!set.rgb.empty()) append_color(out, &set.rgb[3 * i]);
    append_labels(out, set, more, i);
  }
  return bytes;
}

}  // namespace

std::vector<unsigned char> ply_bytes(const PointSet& set, std::span<const IntField> more) {
  return bytes_of(ply_header(set, more), set, more, 3, [](Packer& out, const std::uint8_t* rgb) {
    for (int channel = 0; channel < 3; ++channel) out.append(rgb[channel]);
  });
}

void write_ply(const std::filesystem::path& path, const PointSet& set) {
  write_file_bytes(path, ply_bytes(set));
}

std::vector<unsigned char> pcd_bytes(const PointSet& set, std::span<const IntField> more) {
  return bytes_of(pcd_header(set, more), set, more, 4, [](Packer& out, const std::uint8_t* rgb) {
    out.append(std::uint32_t{rgb[0]} << 16 | std::uint32_t{rgb[1]} << 8 | rgb[2]);
  });
}

}  // namespace planescope::io
