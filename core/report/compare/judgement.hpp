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
  /// Broken rules of level warn, and unguarded().
  int warnings() const;
  /// Idle rules, what the baseline does not have, and parts of it that were left out, a line each.
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
  /// Throws Error if approving `report` would leave a baseline that no single run can make: other
  /// options for some recordings, or fewer frames of one.
  void check_merge(const Report& report) const;
  /// The report's recordings replace those of the baseline; its other recordings stay, unless
  /// `only`. Atomic.
  void approve(const std::filesystem::path& report_json, bool only) const;

 private:
  std::filesystem::path baseline_file_;
  bool is_first_ = false;  // there is no baseline yet
  std::optional<Report> baseline_;
  std::vector<Rule> rules_;
};

/// "frame 3", with its name unless that is the number: "frame 3 (1711.25)".
std::string frame_text(int index, const std::string& name);

/// Whether the baseline, too, refuses this frame of the report, for the same reason.
bool is_known_refusal(const Report& report, const ReportFrame& frame);

nlohmann::ordered_json judgement_json(const Judgement& judgement);

}  // namespace planescope::report
