// What is done to a plane on all frames that it was carried over: one step of undo on each.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

bool is_carried(const FrameLabels& labels, int plane) {
  const LabelPlane* found = labels::find_plane(labels, plane);
  return found && found->origin == LabelOrigin::carried;
}

/// The frames that the plane was carried over, this one among them, ascending: back while it came
/// from the frame before, on while it went to the next one.
std::vector<int> chain_of(const OpenRecording& open, int frame, int plane) {
  std::vector<int> chain{frame};
  for (int at = frame; at > 0; --at) {
    const auto here = labels_at(open, at), before = labels_at(open, at - 1);
    if (!here || !before || !is_carried(*here, plane) || !labels::find_plane(*before, plane)) break;
    chain.insert(chain.begin(), at - 1);
  }
  for (int at = frame + 1; at < open.recording->frame_count(); ++at) {
    const auto there = labels_at(open, at);
    if (!there || !is_carried(*there, plane)) break;
    chain.push_back(at);
  }
  return chain;
}

using Change = FrameLabels (*)(const FrameLabels&, int);

/// Locked planes are left as they are, and counted. The frame looked at is the last step, so that
/// undo begins there.
void change_chain(State& state, const std::string& verb, const std::string& what, Change change) {
  const LabelWork work = label_work(state);
  const int plane = plane_argument(state, "label.chain", "");
  const OpenRecording& open = *state.document.current();
  if (!open.labels->read_only().empty()) throw Error(open.labels->read_only());
  std::vector<int> chain = chain_of(open, state.document.frame, plane);
  std::erase(chain, state.document.frame);
  chain.push_back(state.document.frame);
  std::size_t changed = 0, locked = 0;
  for (const int frame : chain) {
    const auto labels = labels_at(open, frame);
    if (labels::find_plane(*labels, plane)->locked) {
      ++locked;
      continue;
    }
    const labels::LabelEdit edit =
        labels::make_edit(frame, fmt::format("{} P{}{}, carried", verb, plane, what), *labels,
                          change(*labels, plane));
    if (edit.empty()) continue;
    open.labels->commit(edit);
    ++changed;
  }
  let_go(state.view.label);
  const std::string left = locked > 0 ? fmt::format(", {} locked", locked) : "";
  if (changed == 0)
    return say_nothing_done(state,
                            fmt::format("P{}: nothing to change in its chain{}", plane, left));
  say(state, fmt::format("{} P{}{} on {}{}; undo reverts them one by one", verb, plane, what,
                         counted(changed, "frame"), left));
}

Action on_chain(const char* name,
                const char* title,
                const char* key,
                const char* verb,
                const char* what,
                Change change) {
  return {name,      title,
          "Planes",  key,
          "",        [=](State& s, const std::string&) { change_chain(s, verb, what, change); },
          can_label, {}};
}

}  // namespace

std::vector<Action> label_chain_actions() {
  return {
      on_chain("label.chain.h", "Horizontal, on all frames it was carried over", "Ctrl+Shift+H",
               "Make", " h",
               [](const FrameLabels& labels, int plane) {
                 return labels::with_class(labels, plane, Label::h);
               }),
      on_chain("label.chain.v", "Vertical, on all frames it was carried over", "Ctrl+Shift+V",
               "Make", " v",
               [](const FrameLabels& labels, int plane) {
                 return labels::with_class(labels, plane, Label::v);
               }),
      on_chain("label.chain.remove", "Remove the plane from all frames it was carried over",
               "Ctrl+Delete", "Remove", "",
               [](const FrameLabels& labels, int plane) {
                 return labels::without_plane(labels, plane);
               }),
  };
}

}  // namespace planescope::desktop
