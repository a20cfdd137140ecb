#include "core/io/bag/rosbag2_metadata.hpp"

#include <yaml-cpp/yaml.h>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io::rosbag2 {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMostBytes = 1 << 22;

std::vector<std::string> names_in(const fs::path& metadata) {
  if (fs::file_size(metadata) > kMostBytes)
    throw Error(metadata.string() + ": is larger than a list of files, expected one of ros2 bag");
  const auto bytes = read_file_bytes(metadata);
  std::vector<std::string> names;
  try {
    const YAML::Node root = YAML::Load(std::string(bytes.begin(), bytes.end()));
    const YAML::Node list = root["rosbag2_bagfile_information"]["relative_file_paths"];
    for (const YAML::Node& name : list) names.push_back(name.as<std::string>());
  } catch (const YAML::Exception& error) {
    throw Error(metadata.string() + ": is no metadata of ros2 bag: " + error.what());
  }
  if (names.empty())
    throw Error(metadata.string() +
                ": lists no files, expected rosbag2_bagfile_information.relative_file_paths");
  return names;
}

}  // namespace

std::vector<fs::path> files_of_metadata(const fs::path& folder) {
  const fs::path metadata = folder / "metadata.yaml";
  std::vector<fs::path> files;
  for (const std::string& name : names_in(metadata)) {
    fs::path file = folder / fs::path(name).filename();  // once with the folder before it
    if (file.extension() == ".zstd" && fs::exists(fs::path(file).replace_extension()))
      file.replace_extension();  // unpacked since
    if (!fs::is_regular_file(file))
      throw Error(metadata.string() + ": lists " + name + ", which is not there");
    files.push_back(file);
  }
  return files;
}

}  // namespace planescope::io::rosbag2
