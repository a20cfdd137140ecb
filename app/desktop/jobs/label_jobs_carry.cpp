// Labels on their way to the next frame.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/jobs/label_jobs.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {

void LabelJobs::stop_unwanted_carry(const State& state) {
  const CarryJob& carry = state.results.label.carry;
  if (!carrying_ || (carry.running && carry.begun && state.view.mode == Mode::labels)) return;
  carries_.cancel();
  carrying_ = false;
  ++carry_number_;
}

void LabelJobs::pursue_carry(State& state) {
  CarryJob& carry = state.results.label.carry;
  if (!carry.running || carry.begun) return;
  const std::string& refusal =
      state.results.refusal.empty() ? state.results.label.refusal : state.results.refusal;
  if (!state.results.loading && !frames_.busy() && !refusal.empty()) {
    carry = {};
    return say(state, refusal, true);
  }
  if (!state.labels()) return;  // being made
  carry.begun = carrying_ = true;
  const int number = ++carry_number_;
  carries_.replace([this, number, from = carry.from_frame, labels = carry.from_labels,
                    to = state.results.label.frame,
                    existing = state.labels()](std::stop_token stop) {
    int percent = 0;
    const auto tell = [&](double share) {
      if (static_cast<int>(100 * share) <= percent) return;
      percent = static_cast<int>(100 * share);
      deliver_([this, number, share](State& s) {
        if (number == carry_number_) s.results.label.carry.progress = share;
      });
    };
    try {
      const auto carried = std::make_shared<const labels::CarriedLabels>(labels::carry_labels(
          from->recording->frame(from->frame), from->grid, *labels, to->recording->frame(to->frame),
          to->grid, *existing, {}, stop, tell));
      deliver_([this, number, existing, carried](State& s) {
        deliver_carried(s, number, existing, carried);
      });
    } catch (const Cancelled&) {
      // Whoever cancelled it has said so.
    } catch (const std::exception& error) {
      deliver_([this, number, message = std::string(error.what())](State& s) {
        if (number != carry_number_) return;
        carrying_ = false;
        s.results.label.carry = {};
        say(s, message, true);
      });
    }
  });
}

void LabelJobs::deliver_carried(State& state,
                                int number,
                                const std::shared_ptr<const FrameLabels>& existing,
                                const std::shared_ptr<const labels::CarriedLabels>& carried) {
  CarryJob& carry = state.results.label.carry;
  if (number != carry_number_ || !carry.running) return;
  carrying_ = false;
  if (state.labels() != existing) {  // labelled meanwhile: once more, around that
    carry.begun = false;
    return;
  }
  const int from = carry.from;
  carry = {};
  try {
    commit_labels(state, fmt::format("Carry labels from frame {}", from), carried->labels);
  } catch (const std::exception& error) {
    return say(state, error.what(), true);
  }
  carry.from = from;
  carry.done = carried;
  const auto doubtful = std::ranges::count(carried->doubt, std::uint8_t{1});
  say(state,
      fmt::format("{} planes carried from frame {} by {}, {} pixels in doubt are left to you",
                  carried->planes.size(), from, carried->method, doubtful));
}

}  // namespace planescope::desktop
