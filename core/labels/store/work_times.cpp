#include <algorithm>
#include <map>

#include "core/labels/store/journal_records.hpp"
#include "core/labels/store/store.hpp"

namespace planescope::labels {
namespace {

constexpr double kLongestGapS = 60;  // a longer pause was spent on something else

bool is_gesture(RecordKind kind) {
  return kind == RecordKind::edit || kind == RecordKind::undo || kind == RecordKind::redo;
}

}  // namespace

std::vector<WorkTime> work_times(const std::filesystem::path& dir) {
  std::map<std::pair<int, std::string>, WorkTime> times;
  std::map<std::string, std::int64_t> latest_ms;  // gesture of an annotator
  const Journal journal(
      dir / "journal", Journal::Access::read, [&](const JournalPlace&, auto record) {
        const RecordHead head = read_head(record);
        if (!is_gesture(head.kind)) return true;
        WorkTime& time = times[{head.frame, head.annotator}];
        time.frame = head.frame;
        time.annotator = head.annotator;
        ++time.gestures;
        if (const auto before = latest_ms.find(head.annotator); before != latest_ms.end()) {
          const double gap_s = static_cast<double>(head.time_ms - before->second) / 1000;
          time.seconds += std::clamp(gap_s, 0.0, kLongestGapS);
        }
        latest_ms[head.annotator] = head.time_ms;
        return true;
      });
  std::vector<WorkTime> sorted;
  sorted.reserve(times.size());
  for (const auto& [key, time] : times) sorted.push_back(time);
  return sorted;
}

}  // namespace planescope::labels
