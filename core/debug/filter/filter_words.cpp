// Vocabulary of the filter language: tokens, names, and completions in the context of the
// preceding words.

#include "core/debug/filter/filter_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/debug/explain/explain.hpp"

namespace planescope::debug {
namespace {

/// Longer signs precede their prefixes.
constexpr std::string_view kSigns[] = {"||", "&&", "==", "!=", "<=", ">=", "!", "<",
                                       ">",  "+",  "-",  "*",  "/",  "(",  ")"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Letters, and the UTF-8 bytes of the paper's symbols.
bool starts_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

std::size_t name_length(std::string_view text) {
  const auto continues_name = [](char c) { return starts_name(c) || is_digit(c) || c == '.'; };
  return std::find_if_not(text.begin(), text.end(), continues_name) - text.begin();
}

/// The token that begins at `at`, which must not be a space.
FilterToken token_at(std::string_view text, std::size_t at) {
  const std::string_view rest = text.substr(at);
  const auto token = [&](FilterToken::Kind kind, std::size_t length, double value = 0) {
    return FilterToken{{at, at + length}, kind, rest.substr(0, length), value};
  };
  const char c = rest[0];
  if (starts_name(c)) return token(FilterToken::name, name_length(rest));

  if (is_digit(c) || (c == '.' && rest.size() > 1 && is_digit(rest[1]))) {
    double value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    const FilterToken number = token(FilterToken::number, end - rest.data(), value);
    if (error == std::errc::result_out_of_range) fail_filter(number, "number out of range");
    const std::size_t unit = name_length(rest.substr(number.text.size()));
    if (unit == 0) return number;
    const FilterToken whole = token(FilterToken::number, number.text.size() + unit);
    fail_filter(whole, fmt::format("'{}' is not a number; omit the unit (m or deg)", whole.text));
  }

  for (const std::string_view sign : kSigns)
    if (rest.starts_with(sign)) return token(FilterToken::sign, sign.size());
  const FilterToken wrong = token(FilterToken::sign, 1);
  if (c == '=' || c == '&' || c == '|')
    fail_filter(wrong, fmt::format("did you mean '{0}{0}'?", c));
  const bool printable = c > ' ' && c < 0x7f;
  fail_filter(wrong,
              printable ? fmt::format("unexpected '{}'", c) : "unexpected control character");
}

using View = const EventView&;
using Node = const planes::OctreeNode&;
using Facts = const NodeFacts&;

bool is_decide(View e) { return e.event.type == planes::EventType::decide; }

/// The facts for nodes with labeled points and metric noise; null on depth images.
const NodeFacts* facts_in_space(View e) { return e.run.is_on_image() ? nullptr : e.facts(); }

/// The facts if the fit was computed, by Criterion 3 or for the candidate itself.
const NodeFacts* fitted(View e) {
  const NodeFacts* known = e.facts();
  if (!known) return nullptr;
  if (e.run.is_on_image() && !is_decide(e)) return known;
  const bool asked = is_decide(e) ? e.event.node_case >= static_cast<int>(planes::Case::III)
                                  : e.event.label == known->purity.inlier;
  return asked ? known : nullptr;
}

/// The facts if ground truth is known.
const NodeFacts* truth_facts(View e) {
  return e.run.subject->voxel_truth.known() ? e.facts() : nullptr;
}

template <planes::EventType type>
double is_kind(View e) {
  return e.event.type == type;
}

/// A getter applied to the node, or to its facts, instead of the event.
template <auto get>
double of_node(View e) {
  return e.node() ? static_cast<double>(get(*e.node())) : kAbsent;
}
template <auto get>
double of_facts(View e) {
  const NodeFacts* facts = facts_in_space(e);
  return facts ? static_cast<double>(get(*facts)) : kAbsent;
}

std::uint32_t count_of(Facts f, Label label) {
  return f.purity.inlier == label ? f.purity.n_in : f.purity.n_out;
}

Vec3d position_of(View e) {
  return e.run.subject->prepared.voxels.points[e.event.point].cast<double>();
}

template <int axis>
double coordinate(View e) {
  const double origin = e.run.subject->prepared.cloud.origin[axis];
  if (const planes::OctreeNode* node = e.node())
    return origin + planes::cell_center(e.run.octree(), *node)[axis];
  return e.event.point >= 0 ? origin + position_of(e)[axis] : kAbsent;
}

/// Absent if gravity is unknown, because h and v are then meaningless.
double value_of(Label label) {
  return label == Label::unknown ? kAbsent : static_cast<double>(label);
}

double label_of(View e) {
  if (e.event.label != Label::unknown) return static_cast<double>(e.event.label);
  if (e.event.point >= 0)
    return value_of(e.run.subject->prepared.classification.labels[e.event.point]);
  if (const NodeFacts* facts = facts_in_space(e)) return value_of(facts->purity.inlier);
  if (e.event.plane >= 0) return value_of(e.run.timeline.label_of_plane(e.event.plane));
  return kAbsent;
}

double result_of(View e) {
  if (e.event.plane < 0) return kAbsent;
  const Timeline& timeline = e.run.timeline;
  std::int32_t plane = e.event.plane;
  for (const planes::PlaneChange* last = timeline.plane_at(plane, timeline.steps());
       last->into >= 0; last = timeline.plane_at(plane, timeline.steps()))
    plane = last->into;
  return timeline.result_of_plane(plane);
}

/// The value that decided a node of a depth image, in the unit of the stage, or changed a plane.
double value_of_event(View e) {
  const bool decided = is_decide(e) && e.run.is_on_image();
  return decided || e.event.type == planes::EventType::refine ? e.event.value : kAbsent;
}

double true_plane(View e) {
  const VoxelTruth& truth = e.run.subject->voxel_truth;
  if (truth.known() && e.event.point >= 0) return truth.plane[e.event.point];
  return truth_facts(e) ? truth_facts(e)->truth_plane : kAbsent;
}

std::vector<FilterSymbol> fields_of_events() {
  using enum planes::EventType;
  using enum FilterType;
  return {
      {"visit", "a node is dequeued", boolean, is_kind<visit>},
      {"decide", "a node is settled: its case is known", boolean, is_kind<decide>},
      {"found", "a candidate creates a plane, or a part splits off one", boolean, is_kind<found>},
      {"merge", "a candidate or a plane is merged into a plane", boolean,
       [](View e) -> double {
         return e.event.type == planes::EventType::merge || is_join(e.event);
       }},
      {"assign", "a leftover point is assigned to a plane", boolean, is_kind<assign>},
      {"drop", "a leftover point stays unassigned", boolean, is_kind<drop>},
      {"refine", "the objective joins, changes, or drops a plane", boolean, is_kind<refine>},
      {"step", "number of the event, from 1", number,
       [](View e) { return static_cast<double>(e.step); }},
      {"stage", "deciding stage: criteria, merge, assign, or a stage of the objective", stage,
       [](View e) { return static_cast<double>(e.event.stage); }},
      {"label", "h or v: of the candidate, node, point, or plane", label, label_of},
      {"plane", "planes of the event, as P7 or 7", plane,
       [](View e) -> double { return e.event.plane >= 0; }},
      {"point", "points that the event names or moves, or that its node contains", point,
       [](View e) -> double { return e.event.point >= 0 || e.event.node >= 0; }},
      {"result", "id of its plane in the result; 0 if none", number, result_of},
      {"offset", "merge: distance of the candidate from the plane [m]", number,
       [](View e) { return e.event.type == merge ? e.event.value : kAbsent; }},
      {"distance", "assign, drop: distance of the point from the plane [m]", number,
       [](View e) { return e.event.point >= 0 && e.event.value >= 0 ? e.event.value : kAbsent; }},
      {"value", "depth images: decisive value; refine: cost, or change or worth in px", number,
       value_of_event},

      {"case", "decide: case of the node, I II III IV", node_case,
       [](View e) { return is_decide(e) ? e.event.node_case : kAbsent; }},
      {"node", "number of the node", number,
       [](View e) { return e.node() ? e.event.node : kAbsent; }},
      {"parent", "number of its parent; -1 for the root", number,
       of_node<[](Node n) { return n.parent; }>},
      {"depth", "depth of the node, 0 the root", number, of_node<[](Node n) { return n.depth; }>},
      {"size", "points in the node", number, of_node<[](Node n) { return n.size(); }>},
      {"n_in", "inliers: points of the node's majority label", number,
       of_facts<[](Facts f) { return f.purity.n_in; }>},
      {"n_out", "outliers: points of the other label", number,
       of_facts<[](Facts f) { return f.purity.n_out; }>},
      {"r_out", "share of outliers", number, of_facts<[](Facts f) { return f.purity.r_out(); }>},
      {"n_h", "points labeled h", number, of_facts<[](Facts f) { return count_of(f, Label::h); }>},
      {"n_v", "points labeled v", number, of_facts<[](Facts f) { return count_of(f, Label::v); }>},
      {"mse", "decide: e_n as evaluated by Criterion 3 [m², or m by RMS]", number,
       [](View e) {
         return is_decide(e) && fitted(e) && facts_in_space(e) ? fitted(e)->e_n : kAbsent;
       }},
      {"rms", "RMS of the node's fit [m]", number,
       [](View e) { return fitted(e) ? fitted(e)->fit.rms_m() : kAbsent; }},
      {"x", "world x of the node's center or the point [m]", number, coordinate<0>},
      {"y", "world y of the node's center or the point [m]", number, coordinate<1>},
      {"z", "world z of the node's center or the point [m]", number, coordinate<2>},
      {"at_max_depth", "the node is I or III at the deepest level", boolean,
       [](View e) -> double { return e.facts() && e.node()->at_max_depth; }},
      {"divided", "the node was divided", boolean,
       [](View e) -> double { return e.facts() && e.node()->first_child >= 0; }},

      {"truth.mixed", "the node contains points of two true planes", boolean,
       [](View e) -> double {
         return truth_facts(e) && is_mixed_in_truth(*truth_facts(e), e.run.segment_options);
       }},
      {"truth.wrong", "the decision disagrees with ground truth", boolean,
       [](View e) -> double { return !e.run.wrong.empty() && e.run.wrong[e.step - 1] != 0; }},
      {"truth.plane", "true plane of the point, or of most of the node's points; 0 if none", number,
       true_plane},
      {"truth.planes", "number of true planes with points in the node", number,
       [](View e) { return truth_facts(e) ? truth_facts(e)->truth_planes : kAbsent; }},
      {"truth.purity", "share of the node's points that belong to truth.plane", number,
       [](View e) {
         return truth_facts(e)
                    ? static_cast<double>(truth_facts(e)->truth_points) / e.node()->size()
                    : kAbsent;
       }},

      {"theta_mse", "Criterion 3's threshold at the node, in the unit of mse", number,
       of_facts<[](Facts f) { return f.theta_e_n; }>},
  };
}

void append_options(std::vector<FilterSymbol>& all) {
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.is_number() && info.steers_segmentation())
      all.push_back({info.name, info.meaning, FilterType::number, nullptr, &info});
}

void append_values(std::vector<FilterSymbol>& all) {
  const auto add = [&](const char* name, const char* meaning, FilterType type, auto value) {
    all.push_back({name, meaning, type, nullptr, nullptr, static_cast<double>(value)});
  };
  add(planes::to_string(planes::Case::I), "impure", FilterType::node_case, planes::Case::I);
  add(planes::to_string(planes::Case::II), "too few inliers", FilterType::node_case,
      planes::Case::II);
  add(planes::to_string(planes::Case::III), "not planar", FilterType::node_case, planes::Case::III);
  add(planes::to_string(planes::Case::IV), "a plane", FilterType::node_case, planes::Case::IV);
  add("h", "horizontal, like treads", FilterType::label, Label::h);
  add("v", "vertical, like risers", FilterType::label, Label::v);
  for (const planes::Stage stage : planes::stages()) {
    const planes::StageInfo* info = planes::info_of(stage);
    add(planes::to_string(stage), info ? info->title : "a stage of the paper", FilterType::stage,
        stage);
  }
}

/// Other names, including the paper's; those of options are in their table.
constexpr std::pair<std::string_view, std::string_view> kAliases[] = {{"N_in", "n_in"},
                                                                      {"N_out", "n_out"},
                                                                      {"e_n", "mse"},
                                                                      {"theta_e_n", "theta_mse"},
                                                                      {"θ_en", "theta_mse"}};

using Tokens = std::vector<FilterToken>;
using Choices = std::vector<FilterName>;

/// The type of the field with this name; nullopt if there is none.
std::optional<FilterType> field_type(const FilterToken& token) {
  const FilterSymbol* symbol = find_filter_symbol(token.text);
  return symbol && !symbol->value ? std::optional(symbol->type) : std::nullopt;
}

/// Expected type of the value after these words; boolean where a condition starts.
FilterType wanted_type(const Tokens& before) {
  if (before.empty()) return FilterType::boolean;
  const std::string_view sign = before.back().text;
  if (sign == "&&" || sign == "||" || sign == "!" || sign == "(") return FilterType::boolean;
  if (before.size() < 2 || !is_comparison(sign)) return FilterType::number;
  return field_type(before[before.size() - 2]).value_or(FilterType::number);
}

/// Fields if a condition or a number is expected, otherwise values of the type.
Choices values_of(FilterType type) {
  const bool of_fields = type == FilterType::boolean || type == FilterType::number;
  Choices likely, others;
  for (const FilterSymbol& symbol : filter_symbols()) {
    if (symbol.value.has_value() == of_fields) continue;
    if (symbol.type != type && type != FilterType::boolean) continue;
    // Numbers are mostly compared with thresholds.
    const bool is_likely =
        type != FilterType::number || symbol.option || symbol.name.starts_with("theta");
    (is_likely ? likely : others).push_back({symbol.name, symbol.meaning});
  }
  likely.insert(likely.end(), others.begin(), others.end());
  return likely;
}

Choices signs_after(const Tokens& before) {
  const bool compared = before.size() >= 2 && is_comparison(before[before.size() - 2].text);
  const std::optional<FilterType> type = field_type(before.back());
  if (compared || !type || type == FilterType::boolean) return {{"&&", "and"}, {"||", "or"}};
  Choices signs = {{"==", "equal"}, {"!=", "different"}};
  if (type == FilterType::number)
    signs.insert(signs.begin(),
                 {{">", "greater"}, {">=", "at least"}, {"<", "less"}, {"<=", "at most"}});
  return signs;
}

/// Case-insensitive position of the letters in the name; its size if not found.
std::size_t find_letters(std::string_view name, std::string_view letters) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  const auto same = [&](char a, char b) { return lower(a) == lower(b); };
  return static_cast<std::size_t>(
      std::search(name.begin(), name.end(), letters.begin(), letters.end(), same) - name.begin());
}

}  // namespace

std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem) {
  const auto next_from = [&](std::size_t at) { return text.find_first_not_of(" \t\n\r", at); };
  std::vector<FilterToken> tokens;
  try {
    for (std::size_t at = next_from(0); at < text.size(); at = next_from(tokens.back().end))
      tokens.push_back(token_at(text, at));
  } catch (FilterProblem& found) {
    problem = std::move(found);
  }
  return tokens;
}

void fail_filter(const FilterPlace& place, std::string message) {
  throw FilterProblem{place.begin, place.end, std::move(message)};
}

const std::vector<FilterSymbol>& filter_symbols() {
  static const std::vector<FilterSymbol> symbols = [] {
    std::vector<FilterSymbol> all = fields_of_events();
    append_options(all);
    append_values(all);
    return all;
  }();
  return symbols;
}

const FilterSymbol* find_filter_symbol(std::string_view name, std::optional<FilterType> wanted) {
  for (const auto& [alias, meant] : kAliases)
    if (name == alias) name = meant;
  const FilterSymbol* found = nullptr;
  for (const FilterSymbol& symbol : filter_symbols()) {
    if (symbol.name != name && !(symbol.option && symbol.option->symbol == name)) continue;
    if (symbol.type == wanted) return &symbol;
    if (!found) found = &symbol;
  }
  return found;
}

const char* to_string(FilterType type) {
  // In the order of the enum.
  constexpr const char* kTexts[] = {"a number",
                                    "true or false",
                                    "a case (I, II, III, or IV)",
                                    "a label (h or v)",
                                    "a stage, like merge or join",
                                    "a plane",
                                    "a point",
                                    "a plane"};
  return kTexts[static_cast<std::size_t>(type)];
}

std::vector<Completion> complete_filter(const std::string& text, std::size_t cursor) {
  const std::string_view whole = text;
  const std::size_t at = std::min(cursor, text.size());
  std::optional<FilterProblem> ignored;
  Tokens before = filter_tokens(whole.substr(0, at), ignored);
  FilterPlace word{at, at};  // the word at or before the cursor
  if (!before.empty() && before.back().kind == FilterToken::number && before.back().end == cursor)
    return {};
  if (!before.empty() && before.back().kind == FilterToken::name && before.back().end == at) {
    word.begin = before.back().begin;
    word.end = word.begin + filter_tokens(whole.substr(word.begin), ignored).front().end;
    before.pop_back();
  }
  const std::string_view typed = whole.substr(word.begin, at - word.begin);
  const bool wants_value =
      before.empty() || (before.back().kind == FilterToken::sign && before.back().text != ")");
  const Choices choices = wants_value ? values_of(wanted_type(before)) : signs_after(before);
  std::vector<Completion> completions;
  for (const bool at_start : {true, false})
    for (const FilterName& choice : choices) {
      const std::size_t found = find_letters(choice.name, typed);
      if (found < choice.name.size() && (found == 0) == at_start)
        completions.push_back({word.begin, word.end, choice.name, choice.meaning});
    }
  return completions;
}

}  // namespace planescope::debug
