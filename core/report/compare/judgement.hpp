#pragma once

// Check of a report against rules and an earlier report.

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/report/compare/rules.hpp"

namespace planescope::report {

struct Judgement {
  std::string baseline_file;       // as typed; empty: none
  std::optional<Report> baseline;  // its frames as far as read_report() needs for comparison
  std::vector<Rule> rules;
  ReportComparison comparison;   // points into the baseline and the checked report
  std::vector<Breach> breaches;  // worst first
  std::vector<Breach> notes;     // noted_changes(): neither errors nor warnings
  std::vector<IdleRule> idle;
  std::vector<std::string> added;  // "rec: is not in the baseline", one line per recording

  Judgement() = default;
  Judgement(const Judgement&) = delete;
  Judgement& operator=(const Judgement&) = delete;

  int errors() const;
  /// Broken rules of level warn, and unguarded().
  int warnings() const;
  /// Idle rules, and parts missing in the baseline or left out of it, one line each.
  std::vector<std::string> unguarded() const;
  /// In options, weights and the like; empty without a baseline.
  std::vector<std::string> differences() const;
  /// Lines for display, the worst first, the count at the end.
  std::string text() const;
};

/// Implements --baseline and --rules; reads both before any frame is run.
class ReportGuard {
 public:
  /// Paths may be empty: no baseline; with a baseline, the built-in rules. With `approves`, the
  /// baseline may not exist yet, or contain none of the report's frames. Throws Error.
  ReportGuard(std::filesystem::path baseline,
              const std::filesystem::path& rules,
              bool approves = false);
  bool is_on() const { return baseline_ || !rules_.empty(); }
  /// Null if neither was requested. Call once: the baseline moves into the judgement. The judgement
  /// points to the frames of `report`, which must not move while it is used.
  std::shared_ptr<const Judgement> judge(const Report& report);
  /// Throws Error if approving `report` would create a baseline that no single run can produce:
  /// other options for some recordings, or fewer frames of one.
  void check_merge(const Report& report) const;
  /// Replaces the baseline's recordings by the report's. Other recordings stay, unless `only`.
  /// Atomic.
  void approve(const std::filesystem::path& report_json, bool only) const;

 private:
  std::filesystem::path baseline_file_;
  bool approves_ = false;
  bool is_first_ = false;  // the baseline does not exist yet
  std::optional<Report> baseline_;
  std::vector<Rule> rules_;
};

/// "frame 3", followed by its name unless that is the number: "frame 3 (1711.25)".
std::string frame_text(int index, const std::string& name);

/// Whether the baseline also refuses this frame of the report, for the same reason.
bool is_known_refusal(const Report& report, const ReportFrame& frame);

nlohmann::ordered_json judgement_json(const Judgement& judgement);

}  // namespace planescope::report
