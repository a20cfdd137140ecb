#include "app/desktop/actions/actions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "app/desktop/debugger/step_axis.hpp"
#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

/// The root; -1 where a frame without points has none.
std::int32_t root_of(const debug::Run& run) { return run.octree().nodes.empty() ? -1 : 0; }

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// 3: a whole word of the text, 2: the start of one, 1: somewhere in it, 0: nowhere.
int fit_of_word(const std::string& word, const std::string& text) {
  int best = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool starts = at == 0 || !is_letter(text[at - 1]);
    const bool ends = end == text.size() || !is_letter(text[end]);
    best = std::max(best, starts && ends ? 3 : starts ? 2 : 1);
  }
  return best;
}

/// The worse of the words decides, then all of them; -1: not even their letters are there in order.
int fit_of(const std::vector<std::string>& words, const std::string& text) {
  int least = 3, sum = 0;
  for (const std::string& word : words) {
    const int fit = fit_of_word(word, text);
    least = std::min(least, fit);
    sum += fit;
  }
  if (least > 0) return 1000 * least + sum;
  std::size_t from = 0;
  for (const std::string& word : words)
    for (const char c : word) {
      from = text.find(c, from);
      if (from++ == std::string::npos) return -1;
    }
  return sum;
}

/// Words that people look an action up by, besides those of its title and its name.
std::string synonyms_of(const Action& action) {
  static const std::map<std::string, std::string> words = {
      {"point.life", "why lost grey gray unassigned history"},
      {"lost.show", "why lost grey gray unassigned missing"},
      {"fix.point", "why lost grey gray repair remedy"},
      {"fix.search", "why lost repair remedy"},
      {"option.undo", "undo revert back"},
      {"option.redo", "redo again"},
      {"camera.undo", "undo view"},
      {"camera.home", "look all reset"},
      {"camera.top", "look above"},
      {"camera.side", "look"},
      {"camera.front", "look"},
      {"camera.selected", "look zoom selected"},
      {"camera.orthographic", "flat perspective"},
      {"label.undo", "undo revert back"},
      {"label.redo", "redo again"},
      {"join.show", "why merged fused wrong merge"},
      {"recording.open", "load file import"},
      {"picture.save", "screenshot export png"},
      {"steps.save", "animation export gif video"},
      {"theme.toggle", "dark light mode colors"},
      {"intrinsics.edit", "camera calibration focal length"},
      {"image.edges", "alignment aligned registration"},
      {"map.make", "track tracks follow slam"},
      {"gravity.click.floor", "up down level horizontal"},
      {"gravity.click.wall", "up down upright vertical"},
      {"keys", "help shortcuts keyboard"},
      {"option.reset_all", "defaults"}};
  const auto found = words.find(action.name);
  return found == words.end() ? "" : found->second;
}

}  // namespace

const std::vector<Action>& action_table() {
  static const std::vector<Action> table = [] {
    std::vector<Action> all;
    const auto add = [&all](std::vector<Action> part, KeyMode mode) {
      for (Action& action : part) {
        action.mode = mode;
        all.push_back(std::move(action));
      }
    };
    for (auto part : {document_actions, label_mode_actions, view_actions, camera_actions})
      for (Action& action : part()) all.push_back(std::move(action));
    for (auto part : {step_actions, timeline_actions, search_actions, selection_actions,
                      option_actions, compare_actions})
      add(part(), KeyMode::debugger);
    for (auto part :
         {label_tool_actions, label_draw_actions, label_finish_actions, label_plane_actions,
          label_chain_actions, label_review_actions, label_learn_actions})
      add(part(), KeyMode::labels);
    add(gravity_actions(), KeyMode::anywhere);
    add(measure_actions(), KeyMode::debugger);
    add(plane_table_actions(), KeyMode::debugger);
    add(map_actions(), KeyMode::anywhere);
    add(track_actions(), KeyMode::debugger);
    return all;
  }();
  return table;
}

bool has_run(const State& state) { return state.run() != nullptr; }

const Action& find_action(const std::string& name) {
  std::vector<std::string> names;
  for (const Action& action : action_table()) {
    if (action.name == name) return action;
    names.push_back(action.name);
  }
  const std::string near = nearest_name(name, names);
  throw Error("action '" + name + "' does not exist" +
              (near.empty() ? std::string(", `planescope view --actions` lists what there is")
                            : ", did you mean '" + near + "'?"));
}

bool needs_argument(const Action& action) {
  return !action.takes.empty() && action.takes[0] != '[';
}

bool fits(const Action& action, Mode mode) {
  return action.mode == KeyMode::anywhere ||
         (action.mode == KeyMode::labels) == (mode == Mode::labels);
}

const char* click_action(Click click) {
  switch (click) {
    case Click::floor:
      return "gravity.floor";
    case Click::wall:
      return "gravity.wall";
    case Click::point:
    case Click::plane:
      return "measure.end";
    default:
      return nullptr;
  }
}

const Action* action_of_key(const std::string& key, Mode mode) {
  const Action* anywhere = nullptr;
  for (const Action& action : action_table()) {
    if (!fits(action, mode)) continue;
    for (const std::string& one : split(action.keys, ' ')) {
      if (one != key) continue;
      if (action.mode != KeyMode::anywhere) return &action;
      anywhere = &action;
    }
  }
  return anywhere;
}

void apply(State& state, const Command& command) {
  const Action& action = find_action(command.action);
  if (action.takes.empty() && !command.argument.empty())
    throw Error(fmt::format("action {}: takes no argument, but '{}' was given", action.name,
                            command.argument));
  if (!action.can_run(state)) throw Error(fmt::format("action {}: not available now", action.name));
  action.run(state, command.argument);
  drop_done_hint(state);
}

std::string first_key(const Action& action) { return action.keys.substr(0, action.keys.find(' ')); }

std::vector<Offer> palette_offers(const State& state, const std::string& typed) {
  std::string american = lower_case(typed);
  for (std::size_t at; (at = american.find("colour")) != std::string::npos;)
    american.replace(at, 6, "color");
  const std::vector<std::string> wanted = words_of(american);
  std::vector<std::pair<int, Offer>> found;
  const auto add = [&](Offer offer, const std::string& text) {
    const int fit = fit_of(wanted, lower_case(text));
    if (fit >= 0) found.emplace_back(fit, std::move(offer));
  };
  for (const Action& action : action_table())
    if (fits(action, state.view.mode))
      add({&action, "", action.title},
          action.title + "  " + action.name + "  " + synonyms_of(action));
  for (const std::filesystem::path& path : state.document.recent) {
    const std::string title = "Open recent: " + path.filename().string();
    add({&find_action("recording.open"), path.string(), title}, title);
  }
  std::ranges::stable_sort(found, std::ranges::greater(), &std::pair<int, Offer>::first);
  std::vector<Offer> offers;
  for (auto& [fit, offer] : found) offers.push_back(std::move(offer));
  return offers;
}

void say(State& state, std::string message, bool is_error) {
  state.view.message = std::move(message);
  state.view.message_is_error = is_error;
  state.view.did_nothing = false;
  state.view.hint_done = nullptr;
}

void say_hint(State& state, std::string hint, std::function<bool(const State&)> done) {
  say(state, std::move(hint));
  state.view.hint_done = std::move(done);
}

void drop_done_hint(State& state) {
  if (state.view.hint_done && state.view.hint_done(state)) say(state, "");
}

void say_nothing_done(State& state, std::string why) {
  say(state, std::move(why));
  state.view.did_nothing = true;
}

namespace {

/// Scrolls the timeline to the cursor.
void keep_cursor_shown(State& state) {
  const debug::StepRange shown = shown_steps(state);
  if (!shown.contains(state.view.step))
    state.view.shown_steps = scrolled_to(shown, state.view.step, state.run()->steps());
}

}  // namespace

void go_to_step(State& state, std::int32_t step) {
  const debug::Run* run = state.run();
  if (!run) return;
  state.view.step = std::clamp(step, 0, run->steps());
  keep_cursor_shown(state);
  if (state.view.case_colors == CaseColors::shown && state.view.step == run->steps()) {
    state.view.case_colors = CaseColors::ready;
    state.view.color_by = render::ColorBy::planes;
  }
  const planes::TraceEvent* event = state.event();
  Selection selected;
  if (!event) {
    selected.node = root_of(*run);
  } else if (state.view.step < run->steps()) {  // among finished planes nothing stands out
    selected.node = debug::node_at_step(*run, state.view.step);
    selected.plane = event->plane;
    selected.voxel = event->point;
  }
  state.view.selected = selected;
}

void unflash(State& state) {
  if (!state.view.flash) return;
  const std::shared_ptr<const RunView> before = state.results.pinned;
  state.view.flash = false;
  if (before) follow_run(state, *before->run);
}

void refresh_matches(State& state) {
  Search& search = state.view.search;
  search.matches.clear();
  if (search.filter && state.run()) search.matches = search.filter->matching(*state.run());
}

void follow_run(State& state, const debug::Run& before) {
  const debug::Run* now = state.run();
  if (!now || now == &before) return;
  Selection& selected = state.view.selected;
  const bool at_end = state.view.step == before.steps();
  state.view.step = at_end ? now->steps() : debug::same_step(before, state.view.step, *now);
  if (!at_end) keep_cursor_shown(state);
  selected.plane = -1;
  if (selected.node >= 0) {
    selected.node = debug::same_node(before, selected.node, *now);
    if (selected.node < 0) selected.node = root_of(*now);
  }
  if (selected.voxel >= 0 && now->subject != before.subject) {
    const std::size_t source =
        selected.source >= 0
            ? static_cast<std::size_t>(selected.source)
            : debug::source_of_voxel(*before.subject, static_cast<std::uint32_t>(selected.voxel));
    const std::uint32_t voxel = now->subject->frame.index == before.subject->frame.index
                                    ? now->subject->voxel_of_source(source)
                                    : planes::kNoVoxel;
    selected.voxel = voxel == planes::kNoVoxel ? -1 : static_cast<std::int32_t>(voxel);
  }
  if (const planes::TraceEvent* event = state.event();
      event && selected.node >= 0 && event->node == selected.node)
    selected.plane = event->plane;
  refresh_matches(state);
}

int whole_argument(const std::string& action, const std::string& text, int low, int high) {
  const int value = parse_integer(text, "action " + action);
  if (value < low || value > high)
    throw Error(high < low ? fmt::format("action {}: no item {}: the list is empty", action, value)
                           : fmt::format("action {}: {} is out of range, expected {} to {}", action,
                                         value, low, high));
  return value;
}

Clicked click_argument(const State& state, const std::string& action, const std::string& text) {
  const debug::Run& run = *state.run();
  const auto number = [&](std::size_t after, int low, int high) {
    return whole_argument(action, text.substr(after), low, high);
  };
  if (text == "nothing") throw Error("nothing was measured there");
  if (text.starts_with("voxel "))
    return {Clicked::On::voxel, number(6, 0, static_cast<int>(run.subject->voxel_count()) - 1)};
  if (text.starts_with("plane "))
    return {Clicked::On::plane, run_plane_argument(state, action, text.substr(6))};
  const std::vector<double> uv = numbers_argument(action, text, 2);
  const Image16& depth = run.subject->frame.depth;
  if (depth.empty()) throw Error("a cloud has no pixels, click a point of it in space");
  if (!(uv[0] >= 0 && uv[1] >= 0 && uv[0] < depth.width && uv[1] < depth.height))
    throw Error(fmt::format("{} is outside the {} x {} image", text, depth.width, depth.height));
  return {Clicked::On::pixel, static_cast<int>(uv[1]) * depth.width + static_cast<int>(uv[0])};
}

std::int32_t run_plane_argument(const State& state,
                                const std::string& action,
                                const std::string& text) {
  const debug::Timeline& timeline = state.run()->timeline;
  const int number = plane_argument(action, text, 1, timeline.greatest_number());
  const std::int32_t plane = timeline.plane_of_number(number);
  if (plane < 0) throw Error(fmt::format("action {}: there is no plane P{}", action, number));
  return plane;
}

int plane_argument(const std::string& action, const std::string& text, int low, int high) {
  return whole_argument(action, text.starts_with("P") ? text.substr(1) : text, low, high);
}

double number_argument(const std::string& action, const std::string& text) {
  return parse_number(text, "action " + action);
}

std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ','))
    numbers.push_back(parse_number(part, "action " + action));
  if (numbers.size() != count)
    throw Error(fmt::format("action {}: '{}' has {} numbers, expected {}", action, text,
                            numbers.size(), count));
  return numbers;
}

int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return static_cast<int>(i);
  throw Error(fmt::format("action {}: '{}' is unknown, expected {}", action, text,
                          fmt::join(names, " or ")));
}

}  // namespace planescope::desktop
