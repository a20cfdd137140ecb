// A checkpoint is a safetensors file with each tensor's value and Adam's two moments; its metadata
// contains the rest as JSON.

#include "core/lab/training/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/report/page/charts.hpp"

namespace planescope::lab {

namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kFormat = "planescope-training";

struct Group {
  const char* name;
  std::vector<std::vector<float>>& tensors;
};
std::vector<Group> groups(TrainState& state) {
  return {{"value", state.weights.tensors}, {"mean", state.mean}, {"variance", state.variance}};
}

/// Settings that must match to resume a training.
Json identity(const TrainOptions& o, const TrainingPurpose& purpose) {
  Json json = {{"network", o.network.name},
               {"parameters", planes::parameter_count(o.network)},
               {"seed", o.seed},
               {"steps", o.steps},
               {"batch", o.batch},
               {"learning rate", o.learning_rate},
               {"warm-up steps", o.warm_up_steps},
               {"balance of classes", o.balance_classes},
               {"edge weight", o.edge_weight},
               {"steps of an epoch", o.epoch_steps}};
  for (const auto& [name, value] : purpose) json[name] = value;
  return json;
}

void expect_identity(const nlohmann::json& found, const Json& expected, const std::string& what) {
  const auto shown = [](const auto& json) {
    return json.is_string() ? json.template get<std::string>() : json.dump();
  };
  for (const auto& [name, value] : expected.items()) {
    const auto there = found.is_object() ? found.find(name) : found.end();
    if (there == found.end()) throw Error(fmt::format("{}: does not contain its {}", what, name));
    if (const std::string is = shown(*there), wanted = shown(value); is != wanted)
      throw Error(fmt::format("{}: belongs to a different training run: {} {}; expected {}", what,
                              name, is, wanted));
  }
}

Json progress_of(const TrainState& state) {
  Json epochs = Json::array();
  for (const Epoch& epoch : state.epochs) {
    Json sets = Json::array();
    for (const planes::LabelAccuracy& a : epoch.validation)
      sets.push_back({a.edge_right, a.edge, a.inner_right, a.inner});
    epochs.push_back({{"step", epoch.step}, {"loss", epoch.train_loss}, {"validation", sets}});
  }
  return {{"step", state.step}, {"loss_sum", state.loss_sum}, {"epochs", epochs}};
}

std::uint64_t count_of(const nlohmann::json& set, std::size_t index) {
  return static_cast<std::uint64_t>(whole_number(
      set.at(index), 0, std::numeric_limits<std::int64_t>::max(), "a validation count"));
}

void read_progress(const nlohmann::json& json, TrainState& state) {
  state.step = whole_int(json.at("step"), "its step");
  state.loss_sum = json.at("loss_sum").get<double>();
  for (const auto& entry : json.at("epochs")) {
    Epoch& epoch = state.epochs.emplace_back();
    epoch.step = whole_int(entry.at("step"), "an epoch's step");
    epoch.train_loss = entry.at("loss").get<double>();
    for (const auto& set : entry.at("validation"))
      epoch.validation.push_back(
          {count_of(set, 0), count_of(set, 1), count_of(set, 2), count_of(set, 3)});
  }
}

/// Whether the counts are possible for a training of `steps` steps.
bool is_possible(const TrainState& state, int steps) {
  int last = 0;
  for (const Epoch& epoch : state.epochs) {
    if (epoch.step <= last || epoch.validation.size() != state.epochs[0].validation.size())
      return false;
    last = epoch.step;
  }
  // A training that has taken all its steps has also ended its last epoch.
  return last <= state.step && state.step <= steps && (state.step < steps || last == steps);
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path,
                      const TrainState& state,
                      const TrainOptions& options,
                      const TrainingPurpose& purpose) {
  planes::TensorFile file;
  file.metadata = {{"format", kFormat},
                   {"options", identity(options, purpose).dump()},
                   {"progress", progress_of(state).dump()}};
  TrainState copy = state;
  const std::vector<planes::TensorSpec> specs = planes::tensor_specs(options.network);
  for (const Group& group : groups(copy))
    for (std::size_t t = 0; t < specs.size(); ++t)
      file.tensors.push_back({fmt::format("{}/{}", group.name, specs[t].name),
                              {specs[t].shape.begin(), specs[t].shape.end()},
                              std::move(group.tensors[t])});
  planes::write_safetensors(path, file);
}

TrainState read_checkpoint(const std::filesystem::path& path,
                           const TrainOptions& options,
                           const TrainingPurpose& purpose) {
  planes::TensorFile file = planes::read_safetensors(path);
  if (file.metadata["format"] != kFormat)
    throw Error(path.string() + ": not a training checkpoint");
  expect_identity(parse_json<nlohmann::json>(file.metadata["options"], path.string()),
                  identity(options, purpose), path.string());
  TrainState state = begin_training(options);
  const std::vector<planes::TensorSpec> specs = planes::tensor_specs(options.network);
  for (const Group& group : groups(state))
    for (std::size_t t = 0; t < specs.size(); ++t) {
      const std::string name = fmt::format("{}/{}", group.name, specs[t].name);
      const auto found =
          std::find_if(file.tensors.begin(), file.tensors.end(),
                       [&](const planes::Tensor& tensor) { return tensor.name == name; });
      if (found == file.tensors.end() || found->values.size() != group.tensors[t].size())
        throw Error(
            fmt::format("{}: tensor {} is missing or has the wrong size", path.string(), name));
      if (!std::all_of(found->values.begin(), found->values.end(),
                       [](float value) { return std::isfinite(value); }))
        throw Error(
            fmt::format("{}: tensor {} has a value that is not finite", path.string(), name));
      group.tensors[t] = std::move(found->values);
    }
  try {
    read_progress(parse_json<nlohmann::json>(file.metadata["progress"], path.string()), state);
  } catch (const std::exception& error) {
    throw Error(
        fmt::format("{}: its progress record is damaged: {}", path.string(), json_problem(error)));
  }
  if (!is_possible(state, options.steps))
    throw Error(fmt::format("{}: its progress record is damaged: step {} of {} after {} epochs",
                            path.string(), state.step, options.steps, state.epochs.size()));
  return state;
}

// ---- The page ----

namespace {

using kainjow::mustache::html_escape;

report::LineChart chart_over(const std::vector<Epoch>& epochs, const std::string& title) {
  report::LineChart chart{.title = title, .x_name = "steps", .x = {}, .curves = {}};
  for (const Epoch& epoch : epochs) chart.x.push_back(epoch.step);
  return chart;
}

std::string loss_chart(const TrainingSummary& summary) {
  report::LineChart chart = chart_over(summary.epochs, "Loss over the steps of training");
  chart.from_zero = true;
  report::Curve& loss = chart.curves.emplace_back(report::Curve{"training", {}});
  for (const Epoch& epoch : summary.epochs) loss.values.push_back(epoch.train_loss);
  return report::line_chart(chart);
}

std::string edge_chart(const TrainingSummary& summary) {
  report::LineChart chart =
      chart_over(summary.epochs, "Correct labels near edges over the steps, percent");
  for (std::size_t s = 0; s < summary.validation_sets.size(); ++s) {
    report::Curve& curve = chart.curves.emplace_back(report::Curve{summary.validation_sets[s], {}});
    for (const Epoch& epoch : summary.epochs)
      curve.values.push_back(epoch.validation[s].edge_percent());
  }
  return report::line_chart(chart);
}

std::string table(const TrainingSummary& summary) {
  std::string rows = "<tr><th>steps</th><th>loss</th>";
  for (const std::string& name : summary.validation_sets)
    rows += fmt::format("<th>{}</th>", html_escape(name));
  rows += "</tr>\n";
  for (const Epoch& epoch : summary.epochs) {
    rows += fmt::format("<tr><td>{}</td><td>{:.4f}</td>", epoch.step, epoch.train_loss);
    for (const planes::LabelAccuracy& a : epoch.validation)
      rows += fmt::format("<td>{:.2f} / {:.2f}</td>", a.edge_percent(), a.inner_percent());
    rows += "</tr>\n";
  }
  return "<div class=\"wide\"><table>\n" + rows + "</table></div>\n";
}

}  // namespace

std::string training_page(const TrainingSummary& summary) {
  std::string page = "<dl>\n";
  for (const auto& [name, value] : summary.facts)
    page += fmt::format("<dt>{}</dt><dd>{}</dd>\n", html_escape(name), html_escape(value));
  page += "</dl>\n";
  if (summary.epochs.empty()) {
    page += "<p>No epoch is complete yet.</p>\n";
  } else {
    page += "<h2>Loss</h2>\n" + loss_chart(summary);
    page += "<h2>Correct labels within 2 cm of another label [%]</h2>\n" + edge_chart(summary);
    page +=
        "<h2>Epochs</h2>\n<p class=\"soft\">Correct labels within 2 cm of another label / "
        "elsewhere [%]</p>\n" +
        table(summary);
  }
  return report::plain_page(summary.title, page);
}

}  // namespace planescope::lab
