#include "core/replay/filter_program.hpp"

#include <algorithm>
#include <cmath>

namespace planescope {
namespace {

bool concerns_plane(const TraceEvent& event, double plane) {
  return event.plane == plane || event.other == plane;
}

/// a op b; comparisons with a field that the event does not have are false.
double combined(FilterOp::Code code, double a, double b) {
  switch (code) {
    case FilterOp::add:
      return a + b;
    case FilterOp::subtract:
      return a - b;
    case FilterOp::multiply:
      return a * b;
    case FilterOp::divide:
      return a / b;
    case FilterOp::equal:
      return a == b;
    case FilterOp::different:
      return a < b || a > b;  // unlike !=, false for NaN
    case FilterOp::less:
      return a < b;
    case FilterOp::less_equal:
      return a <= b;
    case FilterOp::greater:
      return a > b;
    default:
      return a >= b;
  }
}

}  // namespace

BoundFilter::BoundFilter(const FilterProgram& program, const Run& run)
    : run_(run), program_(program) {
  stack_.reserve(program.size());
  for (FilterOp& op : program_) {
    if (op.code == FilterOp::option) {
      op.number = number_of(*op.option_info, run.options);
      op.code = FilterOp::constant;
    } else if (op.code == FilterOp::is_point) {
      const bool exists = op.number >= 0 &&
                          op.number < static_cast<double>(run.segmentation.plane_of.size()) &&
                          op.number == std::floor(op.number);
      Track track{exists ? static_cast<std::int32_t>(op.number) : -1, {}, {}};
      if (exists) {
        track.nodes = run.timeline.path_of_point(track.point);
        for (const PointChange& change : run.timeline.changes_of_point(track.point))
          track.steps.push_back(change.step);
      }
      op.target = tracks_.size();
      tracks_.push_back(std::move(track));
    }
  }
}

bool BoundFilter::concerns(const EventView& view, const Track& track) const {
  if (track.point < 0) return false;
  return view.event.point == track.point ||
         std::binary_search(track.nodes.begin(), track.nodes.end(), view.event.node) ||
         std::binary_search(track.steps.begin(), track.steps.end(), view.step);
}

bool BoundFilter::matches(std::int32_t step) {
  if (program_.empty()) return true;
  const EventView view{run_, step, *run_.event_at(step)};
  stack_.clear();
  for (std::size_t at = 0; at < program_.size();) {
    const FilterOp& op = program_[at++];
    switch (op.code) {
      case FilterOp::option:  // was bound
      case FilterOp::constant:
        stack_.push_back(op.number);
        break;
      case FilterOp::field:
        stack_.push_back(op.value(view));
        break;
      case FilterOp::is_plane:
        stack_.push_back(concerns_plane(view.event, op.number));
        break;
      case FilterOp::has_plane:
        stack_.push_back(view.event.plane >= 0);
        break;
      case FilterOp::has_point:
        stack_.push_back(view.event.point >= 0 || view.event.node >= 0);
        break;
      case FilterOp::is_point:
        stack_.push_back(concerns(view, tracks_[op.target]));
        break;
      case FilterOp::negate:
        stack_.back() = -stack_.back();
        break;
      case FilterOp::invert:
        stack_.back() = stack_.back() == 0;
        break;
      case FilterOp::and_then:
      case FilterOp::or_else:
        if ((stack_.back() != 0) == (op.code == FilterOp::or_else))
          at = op.target;
        else
          stack_.pop_back();
        break;
      default: {
        const double right = stack_.back();
        stack_.pop_back();
        stack_.back() = combined(op.code, stack_.back(), right);
      }
    }
  }
  return stack_.back() != 0;
}

}  // namespace planescope
