#pragma once

// How the rows of the option table are made. Internal to core/planes/pipeline.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::planes {

/// Throws Error where the value is not in the range.
void check_option_range(double value, const OptionRange& range, const std::string& name);

/// `field` takes PipelineOptions, const or not, and returns a reference to the member: a whole
/// number where that is an int.
template <typename Field>
OptionInfo number(std::string section,
                  std::string name,
                  std::string unit,
                  std::string meaning,
                  Field field,
                  OptionRange range = {}) {
  using Value = std::decay_t<decltype(field(std::declval<PipelineOptions&>()))>;
  constexpr bool kWhole = std::is_same_v<Value, int>;
  return {name,
          std::move(unit),
          std::move(meaning),
          std::move(section),
          [field](const PipelineOptions& o) { return fmt::format("{}", field(o)); },
          [field, range, name](PipelineOptions& o, const std::string& text) {
            Value value{};
            if constexpr (kWhole)
              value = parse_integer(text, "option " + name);
            else
              value = parse_number(text, "option " + name);
            check_option_range(value, range, name);
            field(o) = value;
          },
          kWhole ? OptionKind::whole : OptionKind::number,
          range};
}

template <typename Field>
OptionInfo flag(std::string section, std::string name, std::string meaning, Field field) {
  return {name,
          "on/off",
          std::move(meaning),
          std::move(section),
          [field](const PipelineOptions& o) { return std::string(field(o) ? "on" : "off"); },
          [field, name](PipelineOptions& o, const std::string& text) {
            if (text == "on" || text == "true" || text == "1" || text == "yes") {
              field(o) = true;
            } else if (text == "off" || text == "false" || text == "0" || text == "no") {
              field(o) = false;
            } else {
              throw Error(fmt::format("option {}: '{}' is not on or off", name, text));
            }
          },
          OptionKind::on_off};
}

/// `values[i]` is the text of the enum's i-th value.
template <typename Field>
OptionInfo choice(std::string section,
                  std::string name,
                  std::vector<std::string> values,
                  std::string meaning,
                  Field field) {
  const std::string unit = fmt::format("{}", fmt::join(values, "/"));
  return {name,
          unit,
          std::move(meaning),
          std::move(section),
          [field, values](const PipelineOptions& o) {
            return values.at(static_cast<std::size_t>(field(o)));
          },
          [field, values, name](PipelineOptions& o, const std::string& text) {
            for (std::size_t i = 0; i < values.size(); ++i) {
              if (text != values[i]) continue;
              field(o) = static_cast<std::decay_t<decltype(field(o))>>(i);
              return;
            }
            throw Error(fmt::format("option {}: '{}' is unknown, expected {}", name, text,
                                    fmt::join(values, " or ")));
          },
          OptionKind::choice,
          {},
          values};
}

/// The rows of the methods that are not ours, of those that this build has.
void append_rivals(std::vector<OptionInfo>& table);

}  // namespace planescope::planes
