#include "core/io/folder/folder_write.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const char* color_folder(FolderForm form) { return form == FolderForm::tum ? "rgb" : "color"; }

std::string name_of(FolderForm form, int number, const Frame& frame) {
  return form == FolderForm::tum ? fmt::format("{:.6f}", frame.timestamp_s)
                                 : fmt::format("{:06}", number);
}

/// Colour that is not on depth's pixels.
Json color_json(const Frame& facts) {
  Json pose = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      pose.push_back(facts.T_color_depth.matrix()(row, column));
  return {{"intrinsics", intrinsics_json(facts.color_intrinsics)}, {"T_color_depth", pose}};
}

Json frames_json(const std::vector<WrittenFrame>& frames) {
  Json list = Json::array();
  for (const WrittenFrame& frame : frames) {
    Json entry = {{"name", frame.name}, {"timestamp_s", frame.facts.timestamp_s}};
    if (const auto& gravity = frame.facts.gravity; gravity && gravity->known())
      entry["gravity"] = {gravity->direction.x(), gravity->direction.y(), gravity->direction.z()};
    if (frame.facts.T_world_camera)
      entry["T_world_camera"] = pose_numbers(*frame.facts.T_world_camera);
    list.push_back(std::move(entry));
  }
  return list;
}

const WrittenFrame* first_in_color(const std::vector<WrittenFrame>& frames) {
  for (const WrittenFrame& frame : frames)
    if (frame.has_color) return &frame;
  return nullptr;
}

void expect_one_camera(const std::vector<WrittenFrame>& frames) {
  const Frame& first = frames.front().facts;
  for (const WrittenFrame& frame : frames)
    if (!(frame.facts.intrinsics == first.intrinsics) ||
        frame.facts.depth_unit_m != first.depth_unit_m)
      throw Error(fmt::format(
          "frame {} has another camera or depth unit than frame {}, a recording has one of each",
          frame.facts.index, first.index));
}

void write_tum_list(const fs::path& path,
                    const char* folder,
                    const std::vector<WrittenFrame>& frames,
                    bool all) {
  std::string text = "# timestamp filename\n";
  for (const WrittenFrame& frame : frames)
    if (all || frame.has_color) text += fmt::format("{0} {1}/{0}.png\n", frame.name, folder);
  write_file_text(path, text);
}

/// As Open3D reads it: column by column, and counts per metre.
Json open3d_camera(const Frame& facts) {
  const Intrinsics& k = facts.intrinsics;
  return {{"width", k.width},
          {"height", k.height},
          {"intrinsic_matrix", {k.fx, 0, 0, 0, k.fy, 0, k.cx, k.cy, 1}},
          {"depth_scale", 1 / facts.depth_unit_m}};
}

}  // namespace

WrittenFrame write_frame(const fs::path& dir, FolderForm form, int number, const Frame& frame) {
  const std::string name = name_of(form, number, frame);
  fs::create_directories(dir / "depth");
  write_png(dir / "depth" / (name + ".png"), frame.depth);
  const bool has_color = frame.color.channels == 3;
  if (has_color) {
    fs::create_directories(dir / color_folder(form));
    write_png(dir / color_folder(form) / (name + ".png"), frame.color);
  }
  return facts_of(frame, name);
}

WrittenFrame facts_of(Frame frame, const std::string& name) {
  const bool has_color = frame.color.channels == 3;
  frame.depth = {};
  frame.color = {};
  return {std::move(frame), name, has_color};
}

void write_folder_facts(const fs::path& dir,
                        FolderForm form,
                        const std::vector<WrittenFrame>& frames) {
  if (form == FolderForm::tum) {
    for (std::size_t i = 1; i < frames.size(); ++i)
      if (!(frames[i].facts.timestamp_s > frames[i - 1].facts.timestamp_s))
        throw Error(fmt::format(
            "frame {} is of {:.6f} s, not later than the one before: the form tum names files by "
            "their time",
            frames[i].facts.index, frames[i].facts.timestamp_s));
    write_tum_list(dir / "depth.txt", "depth", frames, true);
    if (first_in_color(frames)) write_tum_list(dir / "rgb.txt", "rgb", frames, false);
  } else {
    write_file_text(dir / "camera_intrinsic.json", json_text(open3d_camera(frames.front().facts)));
  }
  write_recording_facts(dir / "planescope.json", frames);
}

void write_recording_facts(const fs::path& path, const std::vector<WrittenFrame>& frames) {
  expect_one_camera(frames);
  const Frame& facts = frames.front().facts;
  Json sidecar = {{"schema", "planescope.recording/1"},
                  {"intrinsics", intrinsics_json(facts.intrinsics)},
                  {"depth_unit_m", facts.depth_unit_m}};
  if (const WrittenFrame* colored = first_in_color(frames)) {
    sidecar["color_aligned"] = colored->facts.color_aligned;
    if (!colored->facts.color_aligned && colored->facts.color_intrinsics.fx > 0)
      sidecar["color"] = color_json(colored->facts);
  }
  sidecar["frames"] = frames_json(frames);
  write_file_text(path, json_text(sidecar));
}

void write_frame_facts(const fs::path& sidecar, const std::vector<WrittenFrame>& frames) {
  write_file_text(
      sidecar, json_text({{"schema", "planescope.recording/1"}, {"frames", frames_json(frames)}}));
}

}  // namespace planescope::io
