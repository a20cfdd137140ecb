// Runs the program under the fault layer, and compares folders before and after.

#include "faults/fault.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

namespace planescope::faults {
namespace {

namespace fs = std::filesystem;
using testing_cli::read_text;

constexpr unsigned kLongestRunS = 60;

Met run_below_layer(const std::vector<std::string>& args,
                    const fs::path& folder,
                    const Fault* fault) {
  const fs::path counts = folder.string() + ".counts";
  std::ofstream(counts, std::ios::binary) << std::string(kKinds.size() * sizeof(std::uint32_t), 0);
  Met met;
  met.ran = testing_cli::run(args, [&] {
    alarm(kLongestRunS);
    setenv("LD_PRELOAD", PLANESCOPE_FAULT_LAYER, 1);
    setenv("PLANESCOPE_FAULT_COUNTS", counts.c_str(), 1);
    setenv("PLANESCOPE_FAULT_BELOW", folder.c_str(), 1);
    if (!fault) return;
    setenv("PLANESCOPE_FAULT_KIND", fault->kind.c_str(), 1);
    setenv("PLANESCOPE_FAULT_AT", std::to_string(fault->at).c_str(), 1);
    setenv("PLANESCOPE_FAULT_ERRNO", std::to_string(fault->error).c_str(), 1);
    if (fault->stays) setenv("PLANESCOPE_FAULT_STAYS", "1", 1);
  });
  const std::string bytes = read_text(counts);
  for (std::size_t i = 0; i < kKinds.size(); ++i)
    std::memcpy(&met.calls[std::string(kKinds[i])], bytes.data() + i * sizeof(std::uint32_t),
                sizeof(std::uint32_t));
  fs::remove(counts);
  return met;
}

bool is_time_line(const std::string& line) {
  for (const char* part : {"_ms\":", "\"created_utc\":", "\"modified\":", "\"created\":",
                           " time=\"", "Z</d", ", written ", "llvmpipe", " ms", " <small>ms"})
    if (line.find(part) != std::string::npos) return true;
  return false;
}

/// The text without lines that contain times.
std::string without_times(const std::string& text) {
  std::istringstream lines(text);
  std::string line, kept;
  while (std::getline(lines, line))
    if (!is_time_line(line)) kept += line + "\n";
  return kept;
}

/// The first difference of two texts, with context.
std::string parting(const std::string& found, const std::string& expected) {
  const auto at = std::ranges::mismatch(found, expected).in1 - found.begin();
  const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - 60));
  const std::string excerpt = found.substr(from, 120), other = expected.substr(from, 120);
  if (std::ranges::any_of(excerpt + other, [](char c) { return c >= 0 && c < ' ' && c != '\n'; }))
    return " at byte " + std::to_string(at);
  return ": \"" + excerpt + "\", expected \"" + other + "\"";
}

/// A name for what is not finished, which the next run goes on with or removes.
bool is_of_unfinished_work(const std::string& name) {
  for (const char* part :
       {".part", ".partial-", ".report-work", ".checkpoint", "/lock", "journal.jsonl"})
    if (name.find(part) != std::string::npos) return true;
  return false;
}

}  // namespace

bool can_preload() {
  static const bool can = testing_cli::run({"--version"}, [] {
                            setenv("LD_PRELOAD", PLANESCOPE_FAULT_LAYER, 1);
                          }).code == 0;
  return can;
}

Met run_counted(const std::vector<std::string>& args, const fs::path& folder) {
  return run_below_layer(args, folder, nullptr);
}

Met run_faulted(const std::vector<std::string>& args, const fs::path& folder, const Fault& fault) {
  return run_below_layer(args, folder, &fault);
}

Snapshot snapshot(const fs::path& folder) {
  Snapshot found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    const std::string ending = entry.path().extension().string();
    if (entry.is_directory())
      found[name + "/"];
    else if (entry.path().filename() == "journal")
      found[name];  // contains times; label files show its edits
    else if (ending == ".json" || ending == ".html" || ending == ".xml")
      found[name] = without_times(read_text(entry.path()));
    else
      found[name] = read_text(entry.path());
  }
  return found;
}

Snapshot without_unfinished_work(Snapshot files) {
  std::erase_if(files, [](const auto& file) { return is_of_unfinished_work(file.first); });
  return files;
}

std::string damage(const Snapshot& found, const Snapshot& before, const Snapshot& wanted) {
  const auto is_in = [](const Snapshot& files, const auto& file) {
    const auto at = files.find(file.first);
    return at != files.end() && at->second == file.second;
  };
  std::string text;
  for (const auto& [name, content] : before)
    if (!found.contains(name) && wanted.contains(name)) text += name + " is lost\n";
  for (const auto& file : found)
    if (!is_in(before, file) && !is_in(wanted, file) && !is_of_unfinished_work(file.first))
      text += file.first + " is neither old nor new\n";
  return text;
}

std::string differences(const Snapshot& found, const Snapshot& expected) {
  std::string text;
  for (const auto& [name, content] : expected) {
    const auto at = found.find(name);
    if (at == found.end())
      text += name + " is missing\n";
    else if (at->second != content)
      text += name + " differs" + parting(at->second, content) + "\n";
  }
  for (const auto& [name, content] : found)
    if (!expected.contains(name)) text += name + " is left over\n";
  return text;
}

}  // namespace planescope::faults
