// Tuning search: values to try for each option, from coarse steps to fine ones.

#include "core/lab/tuning/tuning_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "core/model/text.hpp"

namespace planescope::lab {

// ---- Values to try ----

namespace {

constexpr double kWidestRange = 100;  // numbers at the end of a wider range stay there

/// Readable numbers for profiles.
double rounded(double value) {
  return parse_number(fmt::format("{:.4g}", value), "a number of tuning");
}

std::vector<double> numbers_to_try(const planes::OptionInfo& info, double now, double factor) {
  const auto [low, high, excluded] = info.range;
  const double span = high - low;
  const double up = now - low, down = high - now;
  const double distance = std::min(up, down);
  const double end = down < up ? high : low;
  const double away = down < up ? -1 : 1;
  if (distance > 0) return {end + away * distance / factor, end + away * distance * factor};
  if (span <= kWidestRange) return {end + away * span * (factor - 1) / 4};
  return {};
}

/// A whole number moves by at least one.
double moved(const planes::OptionInfo& info, double now, double value) {
  if (info.kind != planes::OptionKind::whole || std::round(value) != now) return rounded(value);
  return value < now ? now - 1 : now + 1;
}

}  // namespace

planes::PipelineOptions with_setting(planes::PipelineOptions options, const Setting& setting) {
  for (const auto& [name, value] : setting) planes::set_option(options, name, value);
  return options;
}

bool is_tunable(const planes::OptionInfo& info) {
  if (info.section == "rivals") return info.name != "ransac_seed";  // no seed is better
  if (info.name == "voxel_size_m") return true;
  if (info.section == "classifier") return info.is_number();
  return info.steers_segmentation() && info.name != "profile";
}

std::vector<std::string> values_to_try(const planes::OptionInfo& info,
                                       const planes::PipelineOptions& options,
                                       double factor) {
  const bool idle = !info.matters(options) || planes::is_idle(info, options) ||
                    (info.name.starts_with("pca_") && options.classifier != "pca");
  if (idle) return {};
  const std::string now = info.get(options);
  std::vector<std::string> values;
  if (info.is_number()) {
    const double number = planes::number_of(info, options);
    for (const double value : numbers_to_try(info, number, factor))
      values.push_back(planes::number_text(info, moved(info, number, value)));
  } else if (factor == kTuningFactors[0]) {
    values = info.kind == planes::OptionKind::on_off ? std::vector<std::string>{"off", "on"}
                                                     : info.choices;
  }
  std::erase(values, now);
  return values;
}

// ---- The search ----

namespace {

constexpr double kLeastGain = 0.05;    // points of the score
constexpr double kLeastErrors = 1.25;  // a single frame gives 1, two equal ones give 1.4 or more

Setting changed(Setting setting, const std::string& option, const std::string& value) {
  setting[option] = value;
  return setting;
}

class Search {
 public:
  explicit Search(const TuningSearch& search) : search_(search) {}

  Tuned run() {
    Tuned tuned;
    limited_ = false;  // always score the start, whatever the limits
    tuned.base = best_ = scored({Setting{}}).front();
    asked_ = 1;
    limited_ = true;
    try {
      for (const double factor : kTuningFactors)
        while (step(factor)) {
        }
      tuned.complete = true;
    } catch (const TuningSpent&) {
    }
    tuned.asked = asked_;
    limited_ = false;
    tuned.changes = take_back();
    tuned.best = best_;
    return tuned;
  }

 private:
  struct Promising {
    std::string option, value;
    double gain = 0;
  };

  /// Throws TuningSpent if there are not enough trials left; still scores those within the limit.
  std::vector<Trial> scored(std::vector<Setting> settings) {
    const int left = search_.trials - asked_;
    const bool spent = limited_ && std::cmp_greater(settings.size(), left);
    if (spent) settings.resize(static_cast<std::size_t>(std::max(0, left)));
    asked_ += limited_ ? static_cast<int>(settings.size()) : 0;
    std::vector<Trial> trials = search_.evaluate(settings, limited_);
    assert(trials.size() == settings.size());
    if (spent) throw TuningSpent();
    return trials;
  }

  /// Returns whether any value was taken.
  bool step(double factor) {
    const planes::PipelineOptions now = with_setting(search_.base, best_.setting);
    std::vector<Promising> tried;
    std::vector<Setting> settings;
    for (const std::string& option : search_.options) {
      const planes::OptionInfo& info = planes::find_option(option);
      for (const std::string& value : values_to_try(info, now, factor)) {
        tried.push_back({option, value});
        settings.push_back(normal(changed(best_.setting, option, value)));
      }
    }
    const std::vector<Trial> trials = scored(std::move(settings));
    std::vector<Promising> promising;
    for (std::size_t i = 0; i < trials.size(); ++i)
      if (const Gain gain = gain_of(trials[i], best_); gain.counts())
        promising.push_back({tried[i].option, tried[i].value, gain.mean});
    std::ranges::stable_sort(promising, std::greater<>(), &Promising::gain);
    std::vector<std::string> taken;
    for (const auto& [option, value, gain] : promising) {
      if (std::ranges::find(taken, option) != taken.end()) continue;  // has a better value
      const Trial trial = scored({normal(changed(best_.setting, option, value))}).front();
      if (!gain_of(trial, best_).counts()) continue;
      best_ = trial;
      taken.push_back(option);
    }
    return !taken.empty();
  }

  std::vector<TakenBack> take_back() {
    while (true) {
      std::vector<Setting> settings;
      std::vector<TakenBack> changes;
      for (const auto& [option, value] : best_.setting) {
        changes.push_back({option, {}});
        settings.push_back(best_.setting);
        settings.back().erase(option);
      }
      std::vector<Trial> trials = scored(std::move(settings));
      for (std::size_t i = 0; i < trials.size(); ++i) changes[i].without = std::move(trials[i]);
      std::ranges::stable_sort(changes, std::less<>(),
                               [](const TakenBack& t) { return mean_score(t.without); });
      const bool all_matter = changes.empty() || gain_of(best_, changes.back().without).counts();
      if (all_matter) return changes;
      best_ = changes.back().without;
    }
  }

  /// Without options equal to those at the start of the search.
  Setting normal(Setting setting) const {
    std::erase_if(setting, [&](const auto& one) {
      return planes::find_option(one.first).get(search_.base) == one.second;
    });
    return setting;
  }

  const TuningSearch& search_;
  Trial best_;
  int asked_ = 0;
  bool limited_ = true;
};

}  // namespace

double mean_score(const Trial& trial) {
  double sum = 0;
  for (const double score : trial.scores) sum += score;
  return trial.scores.empty() ? 0 : sum / static_cast<double>(trial.scores.size());
}

bool Gain::counts() const { return mean >= kLeastGain && mean > kLeastErrors * error; }

Gain gain_of(const Trial& trial, const Trial& than) {
  assert(trial.scores.size() == than.scores.size());
  Gain gain;
  const auto count = static_cast<double>(trial.scores.size());
  std::vector<double> gains;
  for (std::size_t i = 0; i < trial.scores.size(); ++i) {
    const double g = trial.scores[i] - than.scores[i];
    gain.mean += g / count;
    (g > 0 ? gain.better : g < 0 ? gain.worse : gain.alike) += 1;
    gains.push_back(g);
  }
  if (gains.size() < 2) return gain;
  double squares = 0;
  for (const double g : gains) squares += (g - gain.mean) * (g - gain.mean);
  gain.error = std::sqrt(squares / (count - 1) / count);
  return gain;
}

Tuned search_options(const TuningSearch& search) { return Search(search).run(); }

}  // namespace planescope::lab
