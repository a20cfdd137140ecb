#include "core/model/file_bytes.hpp"

#include <fstream>

#include "core/model/error.hpp"

namespace planescope {

std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path,
                                           std::uintmax_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(path.string() + ": no such file");
  if (!std::filesystem::is_regular_file(status)) {
    throw Error(path.string() + ": not a regular file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw Error(path.string() + ": cannot be read: " + error.message());
  if (size > max_bytes) {
    throw Error(path.string() + ": " + std::to_string(size) + " bytes, expected at most " +
                std::to_string(max_bytes));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be opened for reading");
  std::vector<unsigned char> bytes(size);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (file.gcount() != static_cast<std::streamsize>(size)) {
    throw Error(path.string() + ": read " + std::to_string(file.gcount()) + " bytes, expected " +
                std::to_string(size));
  }
  return bytes;
}

void write_file_bytes(const std::filesystem::path& path, std::span<const unsigned char> bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) throw Error(path.string() + ": cannot be opened for writing");
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.flush();
  if (!file) throw Error(path.string() + ": not all of it could be written (disk full?)");
}

void write_file_text(const std::filesystem::path& path, std::string_view text) {
  write_file_bytes(path, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

}  // namespace planescope
