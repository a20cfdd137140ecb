// Queries on the desktop state, the list of recent recordings, and the state as JSON.

#include "app/desktop/state/state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/cli/output.hpp"
#include "app/desktop/debugger/debugger.hpp"
#include "app/desktop/state/session.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/model/json.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

void add_label_facts(const State& state, nlohmann::ordered_json& json) {
  static constexpr const char* kTools[] = {"wand", "brush", "rectangle", "lasso", "polygon", "cut"};
  const LabelView& view = state.view.label;
  const OpenRecording* open = state.document.current();
  const labels::LabelStore* store = open ? open->labels.get() : nullptr;
  const std::shared_ptr<const FrameLabels> labels = state.labels();
  json["mode"] = state.view.mode == Mode::labels ? "labels" : "debugger";
  json["label_tool"] = kTools[static_cast<std::size_t>(view.tool)];
  json["label_plane"] = view.plane;
  json["label_planes"] = labels ? labels->planes.size() : 0;
  json["labelled_pixels"] =
      labels ? labels->plane.data.size() -
                   static_cast<std::size_t>(std::ranges::count(labels->plane.data, 0))
             : 0;
  json["unsaved"] = store && store->any_unsaved();
  json["label_undo"] = store ? store->undo_count() : 0;
  json["stroke_pixels"] = view.stroke ? view.stroke->changed_pixels() : 0;
  json["wand_pixels"] = view.wand.found ? view.wand.found->pixels.size() : 0;
  json["finish_pixels"] = view.finish ? view.finish->changed_pixels() : 0;
  json["hovered_pixel"] = view.hover;
  json["read_only"] = store ? store->read_only() : "";
  const Learning& learning = state.results.label.learning;
  json["learnt_frames"] = learning.learnt ? learning.learnt->frames : 0;
  json["doubtful_frames"] = std::ranges::count_if(
      learning.doubt.of_frame, [](const auto& share) { return share.has_value(); });
  json["label_refusal"] = state.results.label.refusal;
}

}  // namespace

const OpenRecording* Document::current() const {
  return recording >= 0 ? &recordings[static_cast<std::size_t>(recording)] : nullptr;
}

OpenRecording* Document::current() {
  return const_cast<OpenRecording*>(std::as_const(*this).current());
}

const RunView* State::run_view() const {
  return view.flash && results.pinned ? results.pinned.get() : results.current.get();
}

const RunPlanes* State::planes(const RunView* of) const {
  for (const std::shared_ptr<const RunPlanes>& planes : results.planes)
    if (of && planes->of.get() == of) return planes.get();
  return nullptr;
}

const RunView* State::other_view() const {
  if (!view.wiper || !results.pinned || !results.current) return nullptr;
  return view.flash ? results.current.get() : results.pinned.get();
}

const MapView* State::map() const {
  const OpenRecording* open = document.current();
  const MapView* made = results.map.made.get();
  return made && open && made->recording == open->recording ? made : nullptr;
}

std::string State::shown_side() const {
  if (!results.pinned) return "";
  return view.wiper ? "A | B" : view.flash ? "A" : "B";
}

std::shared_ptr<const render::PlaneScene> State::plane_scene(const RunView* of) const {
  if (const RunPlanes* known = planes(of)) return known->scene;
  return of ? of->outlines : nullptr;
}

const debug::Run* State::run() const {
  const RunView* shown = run_view();
  return shown ? shown->run.get() : nullptr;
}

const planes::TraceEvent* State::event() const {
  return run() ? run()->event_at(view.step) : nullptr;
}

void Document::check_output(const std::filesystem::path& out) const {
  for (const OpenRecording& open : recordings) app::check_outside(out, open.path);
}

const LabelFrame* State::label_frame() const {
  const LabelFrame* made = results.label.frame.get();
  const OpenRecording* open = document.current();
  return made && open && made->recording == open->recording && made->frame == document.frame
             ? made
             : nullptr;
}

std::shared_ptr<const FrameLabels> State::labels() const {
  const OpenRecording* open = document.current();
  return label_frame() && open->labels ? open->labels->labels(document.frame) : nullptr;
}

namespace {

/// Normalizes a path, so that different spellings compare equal.
std::filesystem::path full_path(const std::filesystem::path& path) {
  std::error_code gone;  // the folder that a relative path starts from
  const std::filesystem::path full = std::filesystem::absolute(path, gone).lexically_normal();
  return full.has_filename() ? full : full.parent_path();
}

}  // namespace

bool forget_recent(Document& document, const std::filesystem::path& recording) {
  return std::erase(document.recent, full_path(recording)) > 0;
}

void note_recent(Document& document, const std::filesystem::path& recording) {
  forget_recent(document, recording);
  document.recent.insert(document.recent.begin(), full_path(recording));
  if (document.recent.size() > kMostRecent) document.recent.resize(kMostRecent);
}

nlohmann::ordered_json state_facts(const State& state, bool idle) {
  nlohmann::ordered_json json;
  const Document& document = state.document;
  const ViewState& view = state.view;
  json["idle"] = idle;
  json["recording"] = document.current() ? document.current()->path.string() : "";
  json["frame"] = document.frame;
  json["profile"] = planes::to_string(document.options.segment.profile);
  json["method"] = planes::to_string(document.options.method);
  json["refusal"] = state.results.refusal;
  json["step"] = view.step;
  const debug::Run* run = state.run();
  static constexpr const char* kClicks[] = {"", "floor", "wall", "point", "plane"};
  json["gravity"] = run ? to_string(run->subject->prepared.gravity.source) : "";
  json["click"] = kClicks[static_cast<std::size_t>(view.click)];
  json["measured"] = run && view.measured.size() == 2
                         ? debug::measure(*run->subject, view.measured[0], view.measured[1]).text
                         : "";
  json["steps"] = run ? run->steps() : 0;
  const debug::StepRange shown = shown_steps(state);
  json["timeline"] = fmt::format("{}-{}", shown.first, shown.last);
  json["event"] = run && view.step > 0 ? debug::describe_event(*run, view.step) : "";
  json["node"] = view.selected.node;
  json["plane"] =
      run && view.selected.plane >= 0 ? debug::plane_name(*run, view.selected.plane) : "";
  json["voxel"] = view.selected.voxel;
  json["case"] =
      run && view.selected.node >= 0
          ? planes::to_string(
                run->octree().nodes[static_cast<std::size_t>(view.selected.node)].decided)
          : "";
  json["planes"] = run ? run->segmentation.planes.size() : 0;
  const RunPlanes* known = state.planes();
  json["steppable"] =
      known && !known->scene->foot.empty() ? std::ranges::count(known->scene->steppable, true) : -1;
  json["flights"] = known ? known->found.stairs.flights.size() : 0;
  json["detected"] =
      state.run_view() && state.run_view()->score ? state.run_view()->score->detected : -1;
  json["filter"] = view.search.text;
  json["filter_problem"] = view.search.problem.message;
  json["matches"] = view.search.matches.size();
  json["breakpoints"] = document.breakpoints.size();
  json["bookmarks"] = document.bookmarks.size();
  json["marked"] = document.marked.size();
  json["recent"] = nlohmann::ordered_json::array();
  for (const std::filesystem::path& path : document.recent) json["recent"].push_back(path.string());
  json["pinned"] = state.results.pinned != nullptr;
  json["flash"] = view.flash;
  json["shown"] = state.shown_side();
  json["isolated"] = view.isolated;
  json["fixes"] = nlohmann::ordered_json::array();
  for (const debug::Fix& fix : state.results.fix.fixes)
    json["fixes"].push_back(fix.option + "=" + fix.after);
  json["strip"] = state.results.strip_done;
  json["theme"] = view.theme == render::Theme::dark ? "dark" : "light";
  json["tab"] = view.inspector_tab;
  json["tool"] = view.tool_tab;
  json["list"] = view.list_tab;
  json["tracks"] = state.map() ? track_rows(state).size() : 0;
  json["track"] = view.tracks.track;
  json["track_text"] = track_text(state);
  json["message"] = view.message;
  json["undo"] = state.undo.size();
  add_label_facts(state, json);
  json["view"] = view_json(view);
  for (const planes::OptionInfo& info : planes::option_table())
    json["options"][info.name] = info.get(document.options);
  return json;
}

std::string state_text(const State& state, bool idle) {
  return json_text(state_facts(state, idle), 2);
}

}  // namespace planescope::desktop
