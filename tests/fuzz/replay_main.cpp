// fuzz_replay FOLDER...: reads every file FOLDER/TARGET/* with its target, as the fuzzers do. Exits
// with 1 and names the file if one is a finding.

#include <algorithm>
#include <iostream>

#include "core/model/file_bytes.hpp"
#include "fuzz/fuzz.hpp"

namespace {

namespace fs = std::filesystem;
using namespace planescope;

struct Counts {
  int files = 0, refused = 0, harmful = 0;
};

void read(const fuzz::Target& target, const fs::path& path, Counts& counts) {
  std::cerr << path.string() << std::endl;  // printed first, because reading may end the program
  ++counts.files;
  try {
    counts.refused += !fuzz::read(target, read_file_bytes(path)).empty();
  } catch (const std::exception& problem) {
    std::cerr << path.string() << " does harm: " << problem.what() << '\n';
    ++counts.harmful;
  }
}

/// Returns the exit code.
int replay(const fs::path& corpus) {
  Counts counts;
  for (const fuzz::Target& target : fuzz::all_targets()) {
    const fs::path folder = corpus / target.name;
    std::vector<fs::path> paths;
    if (fs::is_directory(folder))
      for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
    if (paths.empty()) {
      std::cerr << folder.string() << ": missing, expected a corpus\n";
      ++counts.harmful;
    }
    std::ranges::sort(paths);
    for (const fs::path& path : paths) read(target, path, counts);
  }
  std::cout << counts.files << " files, " << counts.refused << " of them refused, "
            << counts.harmful << " harmful\n";
  return counts.files > 0 && counts.harmful == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  set_read_limit_bytes(std::uint64_t{64} << 20);
  int code = args.empty() ? 2 : 0;
  for (const std::string& folder : args) code = std::max(code, replay(folder));
  return code;
}
