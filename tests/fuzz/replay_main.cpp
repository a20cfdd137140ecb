// fuzz_replay FOLDER...: reads every file FOLDER/TARGET/* by its target, as the fuzzers do. Exits 1
// where one does harm, and names it.
// fuzz_replay --seeds FOLDER: writes the files that fuzzing begins with.

#include <algorithm>
#include <iostream>

#include "core/model/file_bytes.hpp"
#include "core/model/read_limit.hpp"
#include "fuzz/fuzz.hpp"

namespace {

namespace fs = std::filesystem;
using namespace planescope;

int replay(const fs::path& corpus) {
  int files = 0, refused = 0, harmful = 0;
  for (const fuzz::Target& target : fuzz::all_targets()) {
    const fs::path folder = corpus / target.name;
    if (!fs::is_directory(folder)) {
      std::cerr << folder.string() << ": missing, expected a corpus\n";
      ++harmful;
      continue;
    }
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
    std::ranges::sort(paths);
    for (const fs::path& path : paths) {
      std::cerr << path.string() << std::endl;  // before: it may end the program
      ++files;
      try {
        const std::string refusal = fuzz::read(target, read_file_bytes(path));
        if (refusal.empty()) continue;
        std::cerr << "  refused: " << refusal << '\n';
        ++refused;
      } catch (const std::exception& problem) {
        std::cerr << "  does harm: " << problem.what() << '\n';
        ++harmful;
      }
    }
  }
  std::cout << files << " files, " << refused << " of them refused, " << harmful << " harmful\n";
  return files > 0 && harmful == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && argv[1] == std::string("--seeds")) {
    fuzz::write_seeds(argv[2]);
    return 0;
  }
  set_read_limit_bytes(std::uint64_t{64} << 20);
  int code = argc > 1 ? 0 : 2;
  for (int i = 1; i < argc; ++i) code = std::max(code, replay(argv[i]));
  return code;
}
