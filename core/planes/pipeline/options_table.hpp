#pragma once

// Options by name, as used by --set, `planescope options`, the sliders, profile files and the
// report; also the removed options of earlier versions.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// `on_off` is for switches, `text` for free text such as a file name.
enum class OptionKind : std::uint8_t { number, whole, on_off, choice, text };

/// Range of a number's valid values.
struct OptionRange {
  double min = 0;
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
};

/// A row of the table.
struct OptionInfo {
  std::string name;     // e.g. "theta_n_out"
  std::string title;    // shown to users: "Maximum outliers"
  std::string unit;     // "m", "m2", "deg", "points", "" ...
  std::string meaning;  // one phrase
  std::string section;  // "cloud", "gravity", "classifier", "method", "criteria", "objective",
                        // "rivals", "foot", "stairs"
  std::function<std::string(const PipelineOptions&)> get = {};
  std::function<void(PipelineOptions&, const std::string&)> set =
      {};  // throws Error for invalid values
  OptionKind kind = OptionKind::text;
  OptionRange range = {};                 // for number and whole
  std::vector<std::string> choices = {};  // for choice
  std::string symbol = {};                // symbol in the paper (UTF-8), "θ_Nout"; empty if none
  std::optional<bool> objective = {};     // read only by `refined` (true), or only by the paper's
                                          // profiles (false)
  std::optional<bool> images = {};        // with `refined`, read only for depth images (true), or
                                          // only for clouds (false)
  std::optional<Method> method = {};      // the method it belongs to; nullopt: all methods

  bool steers_segmentation() const { return section == "criteria" || section == "objective"; }
  bool is_number() const { return kind == OptionKind::number || kind == OptionKind::whole; }
  /// Whether a run with these options reads it. Rival methods have their own options, h and v
  /// options are unused without gravity, and foot options are unused without a foot.
  bool matters(const PipelineOptions& o) const {
    const bool of_labels = section == "classifier" || name == "use_labels";
    return (!method || *method == o.method) &&
           !(of_labels && o.gravity.mode == GravityMode::none) &&
           !(section == "foot" && o.foot.radius_m == 0);
  }
};

/// Whether the profile of `options` ignores it: on depth images (`images` true), on clouds (false),
/// or on both (nullopt).
bool is_idle(const OptionInfo& info,
             const PipelineOptions& options,
             std::optional<bool> images = {});

/// All options in pipeline order. Setting `profile` sets the segment options to that
/// profile's defaults.
const std::vector<OptionInfo>& option_table();

/// Options of 0.1 that were removed in 0.2, and the option that replaces them (empty if none).
struct RemovedOptions {
  std::string_view by;
  std::vector<std::string_view> names;
};
const std::vector<RemovedOptions>& removed_options();

/// Throws Error for unknown names, with the replacement if the option was removed, else the most
/// similar name.
const OptionInfo& find_option(const std::string& name);

/// Default value of the option in a profile, as text.
std::string default_value(const OptionInfo& info, Profile profile);

// Numeric access; only for options with is_number().
double number_of(const OptionInfo& info, const PipelineOptions& options);
/// Converts to the text that `set` expects. Whole numbers are rounded, values clamped to the range.
std::string number_text(const OptionInfo& info, double value);

/// Throws Error for unknown names (see find_option()) and invalid values.
void set_option(PipelineOptions& options, const std::string& name, const std::string& value);

/// A user-defined profile: a file with the differences from a built-in profile.
struct ProfileFile {
  Profile base = Profile::refined;
  /// Names and values for set_option().
  std::vector<std::pair<std::string, std::string>> options;
};

/// Throws Error naming the file, what was found and what was expected, including for options that
/// are unknown, of the wrong type or out of range.
ProfileFile read_profile(const std::filesystem::path& path);
/// JSON that read_profile() accepts.
std::string profile_text(const ProfileFile& profile);

/// Applies the argument of --profile: the name of a profile, or a file (contains '.' or '/', or
/// exists). Resets the segment options to the named profile or the file's base, then sets the
/// file's options. Throws Error.
void set_profile(PipelineOptions& options, const std::string& name_or_file);

}  // namespace planescope::planes
