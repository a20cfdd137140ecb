#include "app/commands/report_finish.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cli/output.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/report/data/report_files.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRulesFile = "planescope.rules.json";

void print_facts(const std::filesystem::path& out, const report::Report& report, bool json) {
  const report::ReportTotals totals = report::totals_of(report);
  const std::string page = (out / "index.html").string();
  if (!json) {
    fmt::print("{}: {}, {}\n", page, counted(totals.frames_done, "frame"),
               counted(totals.planes, "plane"));
    if (report.judgement) fmt::print("{}", report.judgement->text());
    return;
  }
  nlohmann::ordered_json facts = {
      {"schema", "planescope/report-written/1"}, {"page", page},
      {"recordings", totals.recordings},         {"frames_done", totals.frames_done},
      {"frames_refused", totals.frames_refused}, {"planes", totals.planes},
      {"rendered", !report.renderer.empty()}};
  if (report.judgement) facts["verdict"] = report::judgement_json(*report.judgement);
  fmt::print("{}\n", facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

/// Of those that could not be processed: how many, whether one is damaged, and the first.
struct Refused {
  int frames = 0;
  bool unreadable = false;
  std::string first;
};

Refused refused_of(const report::Report& report) {
  Refused refused;
  for (const report::ReportRecording& recording : report.recordings)
    for (const report::ReportFrame& frame : recording.frames) {
      if (frame.refused.empty()) continue;
      ++refused.frames;
      refused.unreadable |= frame.unreadable;
      if (refused.first.empty()) refused.first = frame.refused;
    }
  return refused;
}

}  // namespace

report::ReportGuard open_guard(const ReportGuardArgs& args) {
  if (args.approve && args.baseline.empty())
    throw Error("--approve: give --baseline FILE, which the report is to become");
  if (args.approve) check_output_dir(fs::absolute(args.baseline).parent_path());
  if (args.approve && fs::is_directory(args.baseline))
    throw Error("--baseline " + args.baseline.string() + ": is a folder, expected a report.json");
  return {args.baseline, args.rules, args.approve};
}

void check_baseline_place(const ReportGuardArgs& args, const std::filesystem::path& out) {
  if (args.baseline.empty() || args.approve) return;
  if (std::filesystem::weakly_canonical(args.baseline) ==
      std::filesystem::weakly_canonical(out / "report.json"))
    throw Error("--baseline " + args.baseline.string() +
                ": the report would overwrite it; keep the baseline elsewhere");
}

void throw_first_refusal(const report::Report& report) { throw Error(refused_of(report).first); }

int finish_report(const std::filesystem::path& out,
                  report::Report& report,
                  report::ReportGuard& guard,
                  const ReportGuardArgs& args,
                  bool json) {
  if (!report.partial) report.judgement = guard.judge(report);
  report::write_report_files(out, report);
  if (report.partial) throw Cancelled();
  print_facts(out, report, json);
  const Refused refused = refused_of(report);
  if (refused.frames > 0)
    fmt::print(stderr, "planescope: {}: {} frame{} refused, the first: {}\n",
               refused.unreadable ? "error" : "warning", refused.frames,
               refused.frames == 1 ? " was" : "s were", refused.first);
  if (!report.renderer_error.empty())
    fmt::print(stderr, "planescope: rendering failed, the data files are written: {}\n",
               report.renderer_error);
  if (args.approve && refused.unreadable)
    fmt::print(stderr, "planescope: warning: --approve: {} stays as it was\n",
               args.baseline.string());
  else if (args.approve) {
    fs::create_directories(fs::absolute(args.baseline).parent_path());
    guard.approve(out / "report.json");
    fmt::print(stderr, "planescope: {} is the baseline now\n", args.baseline.string());
  }
  if (report.judgement && report.judgement->errors() > 0 && !args.approve) return 1;
  if (refused.unreadable) return 2;
  return report.renderer_error.empty() ? 0 : 3;
}

int run_report_init() {
  if (std::filesystem::exists(kRulesFile))
    throw Error(std::string(kRulesFile) + ": exists already");
  write_file_text(kRulesFile, report::rules_json(report::built_in_rules()));
  fmt::print("{}\n", kRulesFile);
  return 0;
}

}  // namespace planescope::app
