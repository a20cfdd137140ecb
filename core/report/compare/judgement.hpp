#pragma once

// A report checked against rules and against an earlier report.

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/report/compare/rules.hpp"

namespace planescope::report {

struct Judgement {
  std::string baseline_file;       // as it was given; empty: none
  std::optional<Report> baseline;  // its frames as far as they are compared (read_report())
  std::vector<Rule> rules;
  ReportComparison comparison;   // points into the baseline, and into the report that was judged
  std::vector<Breach> breaches;  // worst first
  std::vector<Breach> notes;     // noted_changes(): neither errors nor warnings
  std::vector<IdleRule> idle;
  std::vector<std::string> added;  // "rec: is not in the baseline", a line for each recording

  Judgement() = default;
  Judgement(const Judgement&) = delete;
  Judgement& operator=(const Judgement&) = delete;

  int errors() const;
  /// Broken rules of level warn, idle rules, and what was added.
  int warnings() const;
  /// Idle rules and what was added, a line each.
  std::vector<std::string> unguarded() const;
  /// Of options, weights and the like; none without a baseline.
  std::vector<std::string> differences() const;
  /// Lines for people, the worst first, the count at the end.
  std::string text() const;
};

/// What --baseline and --rules ask for, read before any frame is run.
class ReportGuard {
 public:
  /// Files may be empty: no baseline; with a baseline the built-in rules. Where `may_be_first`, a
  /// baseline that is not there yet is none. Throws Error.
  ReportGuard(std::filesystem::path baseline,
              const std::filesystem::path& rules,
              bool may_be_first = false);
  bool is_on() const { return baseline_ || !rules_.empty(); }
  /// Null where nothing was asked for. To be called once: the baseline moves into the judgement.
  /// The judgement points to the frames of `report`, which must stay where they are while it is
  /// used.
  std::shared_ptr<const Judgement> judge(const Report& report);
  /// The report takes the place of the baseline, whole or not at all.
  void approve(const std::filesystem::path& report_json) const;

 private:
  std::filesystem::path baseline_file_;
  bool is_first_ = false;  // there is no baseline yet
  std::optional<Report> baseline_;
  std::vector<Rule> rules_;
};

nlohmann::ordered_json judgement_json(const Judgement& judgement);

}  // namespace planescope::report
