#include "core/io/picked_gravity.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.gravity/1";

fs::path file_in(const fs::path& label_dir) { return label_dir / "gravity.json"; }

Json json_of(const Vec3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json json_of(const PickedDirection& picked) {
  Json walls = Json::array();
  for (const Vec3d& wall : picked.walls) walls.push_back(json_of(wall));
  return {{"direction", json_of(picked.direction)},
          {"walls", walls},
          {"frame", picked.frame},
          {"frame_sha256", picked.frame_sha256},
          {"note", picked.note}};
}

Vec3d unit_vector(const nlohmann::json& json) {
  const auto values = json.get<std::array<double, 3>>();
  const Vec3d vector(values[0], values[1], values[2]);
  if (!vector.allFinite() || std::abs(vector.norm() - 1) > 1e-3)
    throw Error("a direction is not of length 1");
  return vector.normalized();
}

PickedDirection direction_from(const nlohmann::json& json) {
  PickedDirection picked;
  picked.direction = unit_vector(json.at("direction"));
  for (const auto& wall : json.at("walls")) picked.walls.push_back(unit_vector(wall));
  picked.frame = whole_int(json.at("frame"), "its frame");
  picked.frame_sha256 = json.at("frame_sha256").get<std::string>();
  picked.note = json.at("note").get<std::string>();
  return picked;
}

/// A direction is of use on the very frame that it was clicked on, as labels are.
void expect_same(const Recording& recording, const PickedDirection& picked) {
  const auto other = [&] {
    return Error("was picked on another recording, frame " + std::to_string(picked.frame) +
                 " differs; delete it, or name the recording's own folder with --labels");
  };
  if (picked.frame < 0 || picked.frame >= recording.frame_count()) throw other();
  std::string hash;
  try {
    hash = recording.frame_hash(picked.frame);
  } catch (const Error&) {
    return;  // a damaged frame tells nothing, and is told of where it is read
  }
  if (hash != picked.frame_sha256) throw other();
}

PickedGravity gravity_from(const nlohmann::json& json) {
  if (json.at("schema") != kSchema)
    throw Error("its schema is " + json.at("schema").dump() + ", expected \"" + kSchema + "\"");
  PickedGravity picked;
  if (!json.at("recording").is_null()) picked.recording = direction_from(json.at("recording"));
  for (const auto& one : json.at("frames")) {
    PickedDirection direction = direction_from(one);
    picked.frames[direction.frame] = std::move(direction);
  }
  return picked;
}

}  // namespace

const PickedDirection* PickedGravity::of(int frame) const {
  const auto own = frames.find(frame);
  if (own != frames.end()) return &own->second;
  return recording ? &*recording : nullptr;
}

PickedGravity read_picked_gravity(const fs::path& label_dir, const Recording& recording) {
  const fs::path file = file_in(label_dir);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  const nlohmann::json json = read_json<nlohmann::json>(file);
  try {
    PickedGravity picked = gravity_from(json);
    if (picked.recording) expect_same(recording, *picked.recording);
    for (const auto& [index, direction] : picked.frames) expect_same(recording, direction);
    return picked;
  } catch (const nlohmann::json::exception&) {
    throw Error(file.string() +
                ": is no picked gravity that can be read, expected \"schema\", \"recording\" and "
                "\"frames\" as planescope view writes them");
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
}

void write_picked_gravity(const fs::path& label_dir, const PickedGravity& picked) {
  const fs::path file = file_in(label_dir);
  std::error_code failed;
  if (picked.empty()) {
    fs::remove(file, failed);
    if (failed) throw Error(file.string() + ": cannot be removed: " + failed.message());
    return;
  }
  Json json;
  json["schema"] = kSchema;
  json["recording"] = picked.recording ? json_of(*picked.recording) : Json();
  json["frames"] = Json::array();
  for (const auto& [index, direction] : picked.frames) json["frames"].push_back(json_of(direction));
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  fs::create_directories(label_dir, failed);
  if (failed) throw Error(label_dir.string() + ": cannot be made: " + failed.message());
  write_file_text(file, text, Durable::yes);
}

void apply_picked_gravity(const PickedGravity& picked, Frame& frame) {
  const PickedDirection* direction = picked.of(frame.index);
  if (direction && !frame.gravity)
    frame.gravity = Gravity{direction->direction, GravitySource::picked, 1, direction->note};
}

std::shared_ptr<const Recording> with_picked_gravity(std::shared_ptr<const Recording> recording,
                                                     PickedGravity picked) {
  if (picked.empty()) return recording;
  return with_changed_frames(std::move(recording), [picked = std::move(picked)](Frame& frame) {
    apply_picked_gravity(picked, frame);
  });
}

}  // namespace planescope::io
