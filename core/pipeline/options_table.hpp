#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/pipeline/pipeline.hpp"

namespace planescope {

/// One option by its name, as `--set`, `planescope options`, the sliders and the report know it.
struct OptionInfo {
  std::string name;     // e.g. "theta_n_out"
  std::string unit;     // "m", "m2", "deg", "points", "" ...
  std::string meaning;  // one phrase
  std::string section;  // "cloud", "gravity", "classifier", "criteria", "refinements"
  std::function<std::string(const PipelineOptions&)> get;
  std::function<void(PipelineOptions&, const std::string&)> set;  // throws Error on a bad value
};

/// Every option there is, in the order of the pipeline. Setting `profile` sets the segment options
/// to that profile's defaults.
const std::vector<OptionInfo>& option_table();

/// Throws Error naming the nearest existing name when `name` is unknown.
void set_option(PipelineOptions& options, const std::string& name, const std::string& value);

}  // namespace planescope
