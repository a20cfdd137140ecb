#include "core/replay/filter_fields.hpp"

#include <algorithm>

#include "core/replay/event_view.hpp"

namespace planescope {
namespace {

const FilterField* find_in(const std::vector<FilterField>& fields, std::string_view name) {
  for (const FilterField& field : fields)
    if (field.name == name ||
        std::find(field.aliases.begin(), field.aliases.end(), name) != field.aliases.end())
      return &field;
  return nullptr;
}

using View = const EventView&;

template <EventType type>
double is_kind(View e) {
  return e.event.type == type;
}

/// A getter that takes the node, or what the criteria saw of it, instead of the event.
template <auto get>
double of_node(View e) {
  return e.node() ? static_cast<double>(get(*e.node())) : kAbsent;
}
template <auto get>
double of_facts(View e) {
  return e.facts() ? static_cast<double>(get(*e.facts())) : kAbsent;
}
template <auto get>
double of_fit(View e) {
  return e.fitted() ? static_cast<double>(get(*e.fitted())) : kAbsent;
}

void append_events(std::vector<FilterField>& fields) {
  const auto kind = [&](const char* name, const char* meaning, FieldValue value) {
    fields.push_back({name, meaning, FilterType::boolean, value});
  };
  using enum EventType;
  kind("visit", "a node is dequeued", is_kind<visit>);
  kind("decide", "a node is settled: its case is known", is_kind<decide>);
  kind("found", "a candidate founds a plane, or a part splits off one", is_kind<found>);
  kind("merge", "a candidate joins a plane", is_kind<merge>);
  kind("assign", "a leftover point is given to a plane", is_kind<assign>);
  kind("drop", "a leftover point stays without a plane", is_kind<drop>);
  kind("refine", "a refinement changes a plane or a point", is_kind<refine>);
  kind("wait", "R3: a candidate waits for the sure ones", is_kind<wait>);
  kind("leave", "points of a candidate or a small part are left over", is_kind<leave>);

  const auto add = [&](const char* name, const char* meaning, FilterType type, FieldValue value) {
    fields.push_back({name, meaning, type, value});
  };
  using enum FilterType;
  add("step", "number of the event, from 1", number,
      [](View e) { return static_cast<double>(e.step); });
  add("stage", "what decided: criteria, merge, assign, or a refinement, R1 to R8, split",
      FilterType::stage, [](View e) { return static_cast<double>(e.event.stage); });
  add("refinement", "the refinement that decided: R1 to R8, split", FilterType::stage, [](View e) {
    return refinement_of(e.event.stage) ? static_cast<double>(e.event.stage) : kAbsent;
  });
  add("label", "h or v: of the candidate, node, point or plane", FilterType::label, label_of);
  add("plane", "planes that the event concerns, as P7 or 7", FilterType::plane, nullptr);
  add("point", "points that the event names, moves or has in its node", FilterType::point, nullptr);
  add("result", "id in the result of what its plane became, 0 none", number, result_of);
  add("offset", "merge: distance of the candidate from the plane [m]", number,
      [](View e) { return e.event.type == merge ? e.event.value : kAbsent; });
  add("distance", "assign, drop, R5: distance of the point from the plane [m]", number,
      [](View e) { return e.event.point >= 0 && e.event.value >= 0 ? e.event.value : kAbsent; });
}

using Node = const OctreeNode&;
using Facts = const NodeFacts&;

std::uint32_t count_of(Facts f, Label label) {
  return f.purity.inlier == label ? f.purity.n_in : f.purity.n_out;
}

void append_nodes(std::vector<FilterField>& fields) {
  const auto add = [&](const char* name, const char* meaning, FieldValue value,
                       std::vector<std::string> aliases = {}) {
    fields.push_back({name, meaning, FilterType::number, value, nullptr, std::move(aliases)});
  };
  fields.push_back({"case", "decide: case of the node, I II III IV", FilterType::node_case,
                    [](View e) { return e.is_decide() ? e.event.node_case : kAbsent; }});
  add("node", "number of the node", [](View e) { return e.node() ? e.event.node : kAbsent; });
  add("parent", "number of its parent, -1 of the root", of_node<[](Node n) { return n.parent; }>);
  add("depth", "depth of the node, 0 the root", of_node<[](Node n) { return n.depth; }>);
  add("size", "points in the node", of_node<[](Node n) { return n.size(); }>);
  add("n_in", "inliers: points of the node's majority label",
      of_facts<[](Facts f) { return f.purity.n_in; }>, {"N_in"});
  add("n_out", "outliers: points of the other label",
      of_facts<[](Facts f) { return f.purity.n_out; }>, {"N_out"});
  add("r_out", "share of outliers", of_facts<[](Facts f) { return f.purity.r_out(); }>);
  add("n_h", "points labelled h", of_facts<[](Facts f) { return count_of(f, Label::h); }>);
  add("n_v", "points labelled v", of_facts<[](Facts f) { return count_of(f, Label::v); }>);
  add("mse", "decide: e_n as Criterion 3 judged it [m², or m by RMS]",
      [](View e) { return e.is_decide() && e.fitted() ? e.fitted()->e_n : kAbsent; }, {"e_n"});
  add("rms", "RMS of the node's fit [m]", of_fit<[](Facts f) { return f.fit.rms_m(); }>);
  add("sigma_ang", "standard deviation of the normal's direction [deg]", sigma_ang_deg_of);
  add("x", "world x of the node's centre or the point [m]",
      [](View e) { return coordinate_of(e, 0); });
  add("y", "world y of the node's centre or the point [m]",
      [](View e) { return coordinate_of(e, 1); });
  add("z", "world z of the node's centre or the point [m]",
      [](View e) { return coordinate_of(e, 2); });
  fields.push_back({"at_max_depth", "the node is I or III at the deepest level",
                    FilterType::boolean,
                    [](View e) { return e.facts() && e.node()->at_max_depth ? 1.0 : 0.0; }});
  fields.push_back({"divided", "the node was divided", FilterType::boolean,
                    [](View e) { return e.facts() && e.node()->first_child >= 0 ? 1.0 : 0.0; }});
}

void append_truth(std::vector<FilterField>& fields) {
  const auto add = [&](const char* name, const char* meaning, FilterType type, FieldValue value) {
    fields.push_back({name, meaning, type, value});
  };
  using enum FilterType;
  add("truth.mixed", "the node holds points of two true planes", boolean,
      [](View e) { return is_mixed(e) ? 1.0 : 0.0; });
  add("truth.wrong", "the decision disagrees with ground truth", boolean,
      [](View e) { return is_wrong(e) ? 1.0 : 0.0; });
  add("truth.plane", "true plane of the point, or of most of the node's points; 0 none", number,
      true_plane_of);
  add("truth.planes", "how many true planes the node holds points of", number, true_planes_of);
  add("truth.purity", "share of the node's points that belong to truth.plane", number,
      true_purity_of);
}

void append_thresholds(std::vector<FilterField>& fields) {
  fields.push_back({"theta_mse",
                    "Criterion 3's threshold at the node, in the unit of mse",
                    FilterType::number,
                    of_facts<[](Facts f) { return f.theta_e_n; }>,
                    nullptr,
                    {"theta_e_n", "θ_en"}});
  fields.push_back({"theta_rms",
                    "largest RMS of a plane at the place [m]",
                    FilterType::number,
                    theta_rms_of,
                    nullptr,
                    {"θ_rms"}});
  fields.push_back({"tau",
                    "how far off its plane a point may lie at the place [m]",
                    FilterType::number,
                    tau_of,
                    nullptr,
                    {"τ"}});
  for (const OptionInfo& info : option_table()) {
    if (!info.is_number() || (info.section != "criteria" && info.section != "refinements"))
      continue;
    FilterField field{info.name, info.meaning, FilterType::number, nullptr, &info};
    if (!info.symbol.empty() && !find_in(fields, info.symbol)) field.aliases = {info.symbol};
    fields.push_back(std::move(field));
  }
}

}  // namespace

const std::vector<FilterField>& filter_fields() {
  static const std::vector<FilterField> fields = [] {
    std::vector<FilterField> all;
    append_events(all);
    append_nodes(all);
    append_truth(all);
    append_thresholds(all);
    return all;
  }();
  return fields;
}

const FilterField* find_filter_field(std::string_view name) {
  return find_in(filter_fields(), name);
}

}  // namespace planescope
