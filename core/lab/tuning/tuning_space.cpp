#include "core/lab/tuning/tuning_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"

namespace planescope::lab {
namespace {

constexpr double kWidestRange = 100;  // whose end a number leaves by a quarter of it

/// Readable, as a number of a profile should be.
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

/// A whole number moves by one at least.
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

}  // namespace planescope::lab
