// Outcome of a tuning search as text, JSON, profile and page.

#include "core/lab/tuning/tuning_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/page/charts.hpp"

namespace planescope::lab {

namespace {

using Json = nlohmann::ordered_json;

/// "81.23 +- 9.11": over frames.
std::string spread_text(const Trial& trial) {
  const double mean = mean_score(trial);
  double squares = 0;
  for (const double score : trial.scores) squares += (score - mean) * (score - mean);
  const auto count = static_cast<double>(trial.scores.size());
  return fmt::format("{:.2f} +- {:.2f}", mean, count < 2 ? 0.0 : std::sqrt(squares / (count - 1)));
}

std::string half_line(const char* name, const Trial& base, const Trial& tuned) {
  const Gain gain = gain_of(tuned, base);
  return fmt::format("{:<9} {:>6}  {:>15}  {:>15}  {:>15}  {:>6}  {:>5}  {:>5}\n", name,
                     base.scores.size(), spread_text(base), spread_text(tuned),
                     fmt::format("{:+.2f} +- {:.2f}", gain.mean, gain.error), gain.better,
                     gain.worse, gain.alike);
}

Json half_json(const std::vector<std::string>& names, const Trial& base, const Trial& tuned) {
  const Gain gain = gain_of(tuned, base);
  Json json = {{"base_pq", mean_score(base)},
               {"tuned_pq", mean_score(tuned)},
               {"gain", gain.mean},
               {"standard_error", gain.error},
               {"frames", Json::array()}};
  for (std::size_t i = 0; i < names.size(); ++i)
    json["frames"].push_back(
        {{"name", names[i]}, {"base_pq", base.scores[i]}, {"tuned_pq", tuned.scores[i]}});
  return json;
}

}  // namespace

std::vector<PricedTrial> pareto_front(std::vector<PricedTrial> trials) {
  std::ranges::sort(trials, [](const PricedTrial& a, const PricedTrial& b) {
    return a.ms != b.ms ? a.ms < b.ms : a.pq > b.pq;
  });
  std::vector<PricedTrial> front;
  for (PricedTrial& trial : trials)
    if (front.empty() || trial.pq > front.back().pq) front.push_back(std::move(trial));
  return front;
}

std::string verdict(const TuningAnswer& answer) {
  if (answer.tuned.best.setting.empty())
    return "No change gains on the tuning half: profile.json contains the starting options.";
  const Gain gain = gain_of(answer.held_tuned, answer.held_base);
  if (gain.counts() && gain.mean > 2 * gain.error)
    return "The tuned options gain on the held-out frames.";
  if (gain.counts())
    return "The tuned options gain on the held-out frames, but by less than two standard errors: "
           "label more frames to be sure.";
  if (gain_of(answer.held_base, answer.held_tuned).counts())
    return "The tuned options LOSE on the held-out frames: keep the starting options.";
  return "The tuned options DO NOT GAIN on the held-out frames, beyond the effect of a single "
         "frame: the gain is specific to the tuning half.";
}

std::string held_out_note(const TuningAnswer& answer) {
  constexpr std::size_t kFew = 8;        // with more, most kinds of failures are in both halves
  constexpr double kClearlyWorse = 5.0;  // PQ [%]
  const auto& seen = answer.tuned.base.scores;
  const auto& unseen = answer.held_base.scores;
  if (seen.empty() || unseen.empty() || seen.size() > kFew) return "";
  const auto low = std::ranges::min_element(seen), worst = std::ranges::min_element(unseen);
  if (*worst > *low - kClearlyWorse || gain_of(answer.held_tuned, answer.held_base).counts())
    return "";
  return fmt::format(
      "The worst frame at the start, {} (PQ {:.2f}; the worst tuning frame is {}, PQ {:.2f}), is "
      "held out: the search does not use it. Label more frames like it, or assign frames "
      "to the halves with --list.",
      answer.held[static_cast<std::size_t>(worst - unseen.begin())], *worst,
      answer.frames[static_cast<std::size_t>(low - seen.begin())], *low);
}

std::string tuning_text(const TuningAnswer& answer) {
  const Tuned& tuned = answer.tuned;
  std::string text = fmt::format(
      "PQ [%], mean +- standard deviation over frames; gain +- its standard error\n"
      "{:<9} {:>6}  {:>15}  {:>15}  {:>15}  {:>6}  {:>5}  {:>5}\n",
      "half", "frames", "start", "tuned", "gain", "better", "worse", "alike");
  text += half_line("tuning", tuned.base, tuned.best);
  text += half_line("held out", answer.held_base, answer.held_tuned);
  text += fmt::format("\n{}\n", verdict(answer));
  if (const std::string note = held_out_note(answer); !note.empty()) text += note + "\n";
  if (!tuned.changes.empty()) {
    std::size_t width = 6;
    for (const TakenBack& change : tuned.changes) width = std::max(width, change.option.size());
    text += fmt::format("\n{:<{}}  {:>10}  {:>10}  PQ lost on the tuning half without it\n",
                        "option", width, "start", "tuned");
    for (const TakenBack& change : tuned.changes)
      text += fmt::format("{:<{}}  {:>10}  {:>10}  {:.2f}\n", change.option, width,
                          planes::find_option(change.option).get(answer.base),
                          tuned.best.setting.at(change.option),
                          -gain_of(change.without, tuned.best).mean);
  }
  return text + fmt::format("\n{}; {}.\n", counted(answer.trials, "trial"),
                            tuned.complete ? "no further step gains"
                                           : "the search is not finished: rerun with more --trials "
                                             "or --time to resume it");
}

std::string tuning_json(const TuningAnswer& answer) {
  const Tuned& tuned = answer.tuned;
  Json json;
  json["schema"] = "planescope.tuning/1";
  json["verdict"] = verdict(answer);
  const std::string note = held_out_note(answer);
  json["note"] = note.empty() ? Json() : Json(note);
  json["complete"] = tuned.complete;
  json["trials"] = answer.trials;
  json["options"] = Json::array();
  for (const TakenBack& change : tuned.changes)
    json["options"].push_back({{"name", change.option},
                               {"start", planes::find_option(change.option).get(answer.base)},
                               {"tuned", tuned.best.setting.at(change.option)},
                               {"pq_lost_without", -gain_of(change.without, tuned.best).mean}});
  json["tuning"] = half_json(answer.frames, tuned.base, tuned.best);
  json["held_out"] = half_json(answer.held, answer.held_base, answer.held_tuned);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string tuned_profile(const TuningAnswer& answer) {
  const planes::PipelineOptions tuned = with_setting(answer.base, answer.tuned.best.setting);
  planes::ProfileFile profile{tuned.segment.profile, {}};
  for (const planes::OptionInfo& info : planes::option_table()) {
    const bool chosen = is_tunable(info) || info.name == "method" || info.name == "classifier";
    if (const std::string value = info.get(tuned);
        chosen && value != planes::default_value(info, profile.base))
      profile.options.emplace_back(info.name, value);
  }
  return planes::profile_text(profile);
}

// ---- The page ----

namespace {

using kainjow::mustache::html_escape;
using Point = std::pair<double, double>;

Point point_of(const PricedTrial& trial) { return {trial.ms, trial.pq}; }

/// Omits the worst and the slowest tenth of the trials, which would dominate the axes.
std::vector<PricedTrial> worth_a_look(std::vector<PricedTrial> trials) {
  const std::size_t left_out = trials.size() / 10;
  std::ranges::stable_sort(trials, std::greater<>(), &PricedTrial::pq);
  trials.resize(trials.size() - left_out);
  std::ranges::stable_sort(trials, std::less<>(), &PricedTrial::ms);
  trials.resize(trials.size() - left_out);
  return trials;
}

std::string pareto_chart(const TuningAnswer& answer) {
  report::ScatterChart chart{.title = "Accuracy of the tuning half against time",
                             .x_name = "x: CPU time per frame [ms]; y: PQ [%]",
                             .groups = {}};
  report::Scatter trials{"trials", {}, 6, 2}, start{"start", {}, 1, 6}, tuned{"tuned", {}, 2, 6};
  report::Scatter front{"Pareto front", {}, 0, 3.5, true};
  for (const PricedTrial& trial : worth_a_look(answer.priced))
    trials.points.push_back(point_of(trial));
  for (const PricedTrial& trial : pareto_front(answer.priced))
    front.points.push_back(point_of(trial));
  for (const PricedTrial& trial : answer.priced) {
    if (trial.setting.empty()) start.points = {point_of(trial)};
    if (trial.setting == answer.tuned.best.setting) tuned.points = {point_of(trial)};
  }
  for (report::Scatter* group : {&trials, &front, &start, &tuned})
    if (!group->points.empty()) chart.groups.push_back(std::move(*group));
  return report::scatter_chart(chart);
}

std::string setting_text(const Setting& setting) {
  std::string text;
  for (const auto& [name, value] : setting)
    text += fmt::format("{}--set {}={}", text.empty() ? "" : " ", name, value);
  return text.empty() ? "(starting options)" : text;
}

std::string front_table(const TuningAnswer& answer) {
  constexpr const char* kLeft = "style=\"text-align:left;white-space:nowrap\"";
  std::string rows = fmt::format("<tr><th>ms</th><th>PQ</th><th {}>options</th></tr>\n", kLeft);
  for (const PricedTrial& trial : pareto_front(answer.priced))
    rows += fmt::format("<tr><td>{:.1f}</td><td>{:.2f}</td><td {}><code>{}</code></td></tr>\n",
                        trial.ms, trial.pq, kLeft, html_escape(setting_text(trial.setting)));
  return "<div class=\"wide\"><table>\n" + rows + "</table></div>\n";
}

}  // namespace

std::string tuning_page(const TuningAnswer& answer) {
  std::string page = fmt::format("<p><strong>{}</strong></p>\n<pre class=\"wide\">{}</pre>\n",
                                 html_escape(verdict(answer)), html_escape(tuning_text(answer)));
  if (answer.priced.empty()) return report::plain_page("Tuning", page);
  page += fmt::format(
      "<h2>Accuracy against time</h2>\n{}<p class=\"soft\">Trials on the tuning half, without the "
      "worst and the slowest tenth. Held-out frames took {:.1f} ms at the start and {:.1f} ms "
      "tuned. Settings that no other trial beats in both accuracy and time:</p>\n{}",
      pareto_chart(answer), answer.base_ms, answer.tuned_ms, front_table(answer));
  return report::plain_page("Tuning", page);
}

std::string pareto_picture(const TuningAnswer& answer) {
  const std::string chart = pareto_chart(answer);
  const std::size_t body = chart.find('\n') + 1;
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" {}<style>svg{{font-family:system-ui,sans-serif;"
      "background:#f7f7f5;color:#1d2127}}\n@media (prefers-color-scheme:dark){{svg{{background:"
      "#131519;color:#e5e7ea}}}}\n{}</style>\n{}",
      chart.substr(5, body - 5), report::line_chart_style(), chart.substr(body));
}

}  // namespace planescope::lab
