#pragma once

// Options by name: what --set, `planescope options`, the sliders, profile files and the report know
// of each, and the options that earlier versions had.

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

/// `on_off` is for switches; `text` for what can be anything, like a file.
enum class OptionKind : std::uint8_t { number, whole, on_off, choice, text };

/// The values that a number may take.
struct OptionRange {
  double min = 0;
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
};

/// A row of the table.
struct OptionInfo {
  std::string name;     // e.g. "theta_n_out"
  std::string title;    // for people: "Most outliers"
  std::string unit;     // "m", "m2", "deg", "points", "" ...
  std::string meaning;  // one phrase
  std::string section;  // "cloud", "gravity", "classifier", "method", "criteria", "objective",
                        // "rivals", "foot", "stairs"
  std::function<std::string(const PipelineOptions&)> get = {};
  std::function<void(PipelineOptions&, const std::string&)> set =
      {};  // throws Error on a bad value
  OptionKind kind = OptionKind::text;
  OptionRange range = {};                 // of number and whole
  std::vector<std::string> choices = {};  // of choice
  std::string symbol = {};                // the paper's (UTF-8), "θ_Nout"; empty where it has none
  std::optional<bool> objective = {};     // only `refined` reads it, or only the paper's profiles
  std::optional<bool> images = {};        // `refined`: only depth images read it, or only clouds
  std::optional<Method> method = {};      // whose option it is; nothing: every method's

  bool steers_segmentation() const { return section == "criteria" || section == "objective"; }
  bool is_number() const { return kind == OptionKind::number || kind == OptionKind::whole; }
  /// Whether a run with these options reads it: rivals have their own options, options about h and
  /// v do nothing without gravity, and those of a foot nothing without one.
  bool matters(const PipelineOptions& o) const {
    const bool of_labels = section == "classifier" || name == "use_labels";
    return (!method || *method == o.method) &&
           !(of_labels && o.gravity.mode == GravityMode::none) &&
           !(section == "foot" && o.foot.radius_m == 0);
  }
};

/// Whether the profile of `options` does not read it, on depth images (`images`) or on clouds; on
/// either where `images` is not given.
bool is_idle(const OptionInfo& info,
             const PipelineOptions& options,
             std::optional<bool> images = {});

/// Every option there is, in the order of the pipeline. Setting `profile` sets the segment options
/// to that profile's defaults.
const std::vector<OptionInfo>& option_table();

/// Options of 0.1 that 0.2 does not have, and the options that replace them, nothing where none
/// does.
struct RemovedOptions {
  std::string_view by;
  std::vector<std::string_view> names;
};
const std::vector<RemovedOptions>& removed_options();

/// Throws Error when `name` is unknown: what became of it where 0.1 had it, else the nearest
/// existing name.
const OptionInfo& find_option(const std::string& name);

/// What the option is by default in a profile, as text.
std::string default_value(const OptionInfo& info, Profile profile);

// Numbers as numbers: of options with is_number() only.
double number_of(const OptionInfo& info, const PipelineOptions& options);
/// As `set` takes it; whole numbers are rounded, values out of range moved to its end.
std::string number_text(const OptionInfo& info, double value);

/// Throws what find_option() does, and Error on a bad value.
void set_option(PipelineOptions& options, const std::string& name, const std::string& value);

/// A profile of one's own: a file with what differs from a named profile.
struct ProfileFile {
  Profile base = Profile::refined;
  std::vector<std::pair<std::string, std::string>> options;  // name, value as set_option() takes it
};

/// Throws Error naming the file, what was found and what was expected: for an option that is
/// unknown, of another type or out of range, too.
ProfileFile read_profile(const std::filesystem::path& path);
/// JSON, as read_profile() reads it.
std::string profile_text(const ProfileFile& profile);

/// What was typed after --profile: the name of a profile, or a file: something with a '.' or '/' in
/// it, or a file that is there. The segment options become those of the named profile, or of the
/// file's base; what the file sets follows. Throws Error.
void set_profile(PipelineOptions& options, const std::string& name_or_file);

}  // namespace planescope::planes
