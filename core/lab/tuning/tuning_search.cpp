#include "core/lab/tuning/tuning_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

namespace planescope::lab {
namespace {

constexpr double kLeastGain = 0.05;    // points of the score
constexpr double kLeastErrors = 1.25;  // one frame alone makes 1, two alike make 1.4 and more

Setting changed(Setting setting, const std::string& option, const std::string& value) {
  setting[option] = value;
  return setting;
}

class Search {
 public:
  explicit Search(const TuningSearch& search) : search_(search) {}

  Tuned run() {
    Tuned tuned;
    tuned.base = best_ = scored({Setting{}}).front();
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

  /// Throws TuningSpent where more are asked for than may be; those before are scored all the same.
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

  /// Whether anything was taken.
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
      if (std::ranges::find(taken, option) != taken.end()) continue;  // its better value
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

  /// Without what is as the search began with.
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
