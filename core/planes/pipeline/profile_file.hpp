#pragma once

// Profiles of one's own: a file with what is set otherwise than in a named profile.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

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
