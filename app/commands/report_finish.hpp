#pragma once

// The end of a report, whole or joined: held to its rules, written, told.

#include "app/commands/report.hpp"
#include "core/report/compare/judgement.hpp"

namespace planescope::app {

/// Reads what the report is to be held to. Throws Error.
report::ReportGuard open_guard(const ReportGuardArgs& args);

/// Throws Error where the report would take its baseline's place without being approved.
void check_baseline_place(const ReportGuardArgs& args, const std::filesystem::path& out);

/// A report without any frame that was processed is bad input: throws Error with the first reason.
void throw_first_refusal(const report::Report& report);

/// Judges `report`, writes its files into `out`, where its frames lie, and says how it went.
/// Returns the exit code, as run_report(); throws Cancelled where the report is partial.
int finish_report(const std::filesystem::path& out,
                  report::Report& report,
                  report::ReportGuard& guard,
                  const ReportGuardArgs& args,
                  bool json);

}  // namespace planescope::app
