#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/commands/report.hpp"
#include "app/commands/report_finish.hpp"
#include "core/model/error.hpp"
#include "core/report/data/report_json.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

struct ShardReport {
  fs::path dir;
  report::ReportHead head;
  Shard shard;
};

ShardReport read_shard(const fs::path& dir) {
  const fs::path file = dir / "report.json";
  ShardReport read{dir, report::read_report_head(file), {}};
  const report::Report& report = read.head.report;
  if (report.shard.empty()) throw Error(file.string() + ": is a whole report, expected a shard");
  if (report.partial)
    throw Error(file.string() + ": shard " + report.shard +
                " was stopped before its end; run it again with --resume");
  read.shard = parse_shard(report.shard);
  return read;
}

/// What the shards of one report have in common, as report.json writes it.
std::string common_text(const report::Report& report) {
  report::Report common = report;
  common.created_utc.clear();
  common.shard.clear();
  common.renderer.clear();
  common.renderer_error.clear();
  for (report::ReportRecording& recording : common.recordings) recording.frames_asked = 0;
  return report::report_json(common);
}

std::vector<ShardReport> read_shards(const std::vector<fs::path>& dirs) {
  std::vector<ShardReport> shards;
  for (const fs::path& dir : dirs) shards.push_back(read_shard(dir));
  std::ranges::stable_sort(shards, {}, [](const ShardReport& s) { return s.shard.index; });
  const ShardReport& first = shards.front();
  const std::string common = common_text(first.head.report);
  int expected = 1;
  for (const ShardReport& shard : shards) {
    const std::string name = shard.dir.string() + ": shard " + shard.head.report.shard;
    if (shard.shard.count != first.shard.count || common_text(shard.head.report) != common)
      throw Error(name + " is of another report than " + first.dir.string() +
                  ": their recordings, options, weights or builds differ");
    if (shard.shard.index < expected) throw Error(name + " was given twice");
    if (shard.shard.index > expected) break;
    ++expected;
  }
  if (expected <= first.shard.count)
    throw Error(fmt::format("shard {}/{} is missing", expected, first.shard.count));
  return shards;
}

fs::path folder_of(const report::Report& report, std::size_t recording, int index) {
  return report_frame_folder(report.recordings.size(), recording, report.recordings[recording].name,
                             index);
}

}  // namespace

int run_report_merge(const ReportMergeArgs& args) {
  report::ReportGuard guard = open_guard(args.guard);
  check_baseline_place(args.guard, args.out);
  std::vector<ShardReport> shards = read_shards(args.shards);
  for (const ShardReport& shard : shards)
    if (fs::weakly_canonical(shard.dir) == fs::weakly_canonical(args.out))
      throw Error("output " + args.out.string() + " is one of the shards");
  ReportFolder folder(args.out, false);
  folder.give_up();  // what fails half way is begun again
  std::set<fs::path> frames;
  report::Report report = shards.front().head.report;
  report.shard.clear();
  for (report::ReportRecording& recording : report.recordings) recording.frames_asked = 0;
  for (const ShardReport& shard : shards) {
    const report::Report& part = shard.head.report;
    report.created_utc = std::max(report.created_utc, part.created_utc);
    if (report.renderer_error.empty()) report.renderer_error = part.renderer_error;
    for (std::size_t r = 0; r < report.recordings.size(); ++r)
      report.recordings[r].frames_asked += part.recordings[r].frames_asked;
    for (const auto& [recording, index] : shard.head.frames) {
      const fs::path frame = folder_of(report, recording, index);
      folder.take(frame, shard.dir);
      frames.insert(frame);
      report.recordings[recording].frames.push_back(folder.read(frame));
    }
  }
  if (!report.renderer_error.empty()) report.renderer.clear();
  if (report::totals_of(report).frames_done == 0) throw_first_refusal(report);
  folder.commit(true, frames);
  return finish_report(args.out, report, guard, args.guard, args.json);
}

}  // namespace planescope::app
