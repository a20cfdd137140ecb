// fuzz_replay FOLDER...: reads every file FOLDER/TARGET/* by its target, as the fuzzers do. Exits 1
// where one does harm, and names it.
// fuzz_replay --changed SECONDS FOLDER: reads changed copies of them, for so long each target (CPU
// time). What was read last lies in last.TARGET of the folder that it names first: where a run ends
// the program, the bytes that did.
// fuzz_replay --seeds FOLDER: writes the files that fuzzing begins with.

#include <algorithm>
#include <ctime>
#include <iostream>

#include "core/model/file_bytes.hpp"
#include "fuzz/change.hpp"

namespace {

namespace fs = std::filesystem;
using namespace planescope;

constexpr std::size_t kLongest = 32768;  // of a changed file; as in scripts/fuzz

/// In the order of their names; none where the folder is missing, which is told.
std::vector<fs::path> files_of(const fs::path& corpus, const fuzz::Target& target) {
  const fs::path folder = corpus / target.name;
  std::vector<fs::path> paths;
  if (!fs::is_directory(folder))
    std::cerr << folder.string() << ": missing, expected a corpus\n";
  else
    for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

struct Counts {
  int files = 0, refused = 0, harmful = 0;

  void read(const fuzz::Target& target, fuzz::Bytes bytes, const std::string& name) {
    ++files;
    try {
      refused += fuzz::read(target, bytes).empty() ? 0 : 1;
    } catch (const std::exception& problem) {
      std::cerr << name << " does harm: " << problem.what() << '\n';
      ++harmful;
    }
  }
  /// The exit code.
  int tell() const {
    std::cout << files << " files, " << refused << " of them refused, " << harmful << " harmful\n";
    return files > 0 && harmful == 0 ? 0 : 1;
  }
};

int replay(const fs::path& corpus) {
  Counts counts;
  for (const fuzz::Target& target : fuzz::all_targets()) {
    const std::vector<fs::path> paths = files_of(corpus, target);
    counts.harmful += paths.empty();
    for (const fs::path& path : paths) {
      std::cerr << path.string() << std::endl;  // before: it may end the program
      counts.read(target, read_file_bytes(path), path.string());
    }
  }
  return counts.tell();
}

fuzz::ByteVector changed(const fuzz::Target& target,
                         const fuzz::ByteVector& from,
                         std::minstd_rand& random) {
  const fuzz::ChangeBytes change = [&](fuzz::ByteVector& bytes, std::size_t max) {
    fuzz::change_at_random(bytes, max, random);
  };
  fuzz::ByteVector bytes;
  if (target.split && random() % 2 == 0)
    bytes = fuzz::with_changed_piece(target, from, kLongest, random, change);
  if (!bytes.empty()) return bytes;
  bytes = from;
  change(bytes, kLongest);
  return bytes;
}

double cpu_seconds_since(std::clock_t begin) {
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

int replay_changed(double seconds, const fs::path& corpus) {
  Counts counts;
  std::cerr << "what was read last: " << fuzz::memory_folder().string() << std::endl;
  for (const fuzz::Target& target : fuzz::all_targets()) {
    std::vector<fuzz::ByteVector> kept;
    for (const fs::path& path : files_of(corpus, target)) {
      const auto bytes = read_file_bytes(path);
      kept.emplace_back(bytes.begin(), bytes.end());
    }
    counts.harmful += kept.empty();
    const std::string last = std::string("last.") + target.name;
    std::minstd_rand random;  // the same changes every time, as far as time allows
    const std::clock_t begin = std::clock();
    const int harmful = counts.harmful;
    while (!kept.empty() && counts.harmful == harmful && cpu_seconds_since(begin) < seconds) {
      const fuzz::ByteVector bytes = changed(target, kept[random() % kept.size()], random);
      const fs::path written = fuzz::file_of(last, bytes);
      counts.read(target, bytes, written.string());
    }
    if (counts.harmful == harmful) fs::remove(fuzz::memory_folder() / last);
  }
  return counts.tell();
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.size() == 2 && args[0] == "--seeds") {
    fuzz::write_seeds(args[1]);
    return 0;
  }
  set_read_limit_bytes(std::uint64_t{64} << 20);
  if (args.size() == 3 && args[0] == "--changed")
    return replay_changed(std::stod(args[1]), args[2]);
  int code = args.empty() ? 2 : 0;
  for (const std::string& folder : args) code = std::max(code, replay(folder));
  return code;
}
