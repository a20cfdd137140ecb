#include "core/io/sniff.hpp"

#include <algorithm>
#include <cctype>

#include "core/model/error.hpp"

namespace planescope::io {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxDepth = 4;  // folders below the one given; a whole disk is no recording

}  // namespace

std::string extension(const fs::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_ply(const fs::path& path) { return extension(path) == ".ply"; }
bool is_cloud(const fs::path& path) { return is_ply(path) || extension(path) == ".pcd"; }

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t i0 = i, j0 = j;
    while (i < a.size() && digit(a[i])) ++i;
    while (j < b.size() && digit(b[j])) ++j;
    if (i - i0 != j - j0) return i - i0 < j - j0;
    const int order = a.compare(i0, i - i0, b, j0, j - j0);
    if (order != 0) return order < 0;
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // such as 01 and 1: any order, but always the same
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (entry.is_regular_file(ignored) && !entry.path().filename().string().starts_with('.')) {
      files.push_back(entry.path());
    }
  }
  if (error) throw Error(folder.string() + ": cannot be listed: " + error.message());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

std::vector<fs::path> cloud_files_under(const fs::path& folder) {
  std::vector<fs::path> clouds;
  for (const fs::path& file : files_in(folder)) {
    if (is_cloud(file)) clouds.push_back(file);
  }
  std::vector<fs::path> below;
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it.depth() >= kMaxDepth) it.disable_recursion_pending();
    std::error_code ignored;
    if (it.depth() > 0 && is_cloud(it->path()) && it->is_regular_file(ignored)) {
      below.push_back(it->path());
    }
  }
  std::sort(below.begin(), below.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.string(), b.string());
  });
  clouds.insert(clouds.end(), below.begin(), below.end());
  return clouds;
}

}  // namespace planescope::io
