#include "core/io/picked_gravity.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.gravity/1";

fs::path file_in(const fs::path& label_dir) { return label_dir / "gravity.json"; }

void expect_unit(Vec3d& direction, const JsonPlace& place) {
  if (!direction.allFinite() || std::abs(direction.norm() - 1) > 1e-3)
    place.fail_kind("a direction of length 1");
  direction.normalize();
}

}  // namespace

template <typename Fields>
void visit_fields(Fields& fields, Same<PickedDirection> auto& picked) {
  fields("direction", picked.direction);
  fields("walls", picked.walls);
  fields("frame", picked.frame);
  fields("frame_sha256", picked.frame_sha256);
  fields("note", picked.note);
  if constexpr (Fields::kReads) {
    expect_unit(picked.direction, fields.place().at("direction"));
    for (Vec3d& wall : picked.walls) expect_unit(wall, fields.place().at("walls"));
  }
}

template <typename Fields>
void visit_fields(Fields& fields, Same<PickedGravity> auto& picked) {
  fields("recording", picked.recording);
  std::vector<PickedDirection> frames;
  for (const auto& [index, direction] : picked.frames) frames.push_back(direction);
  fields("frames", frames);
  if constexpr (Fields::kReads)
    for (PickedDirection& direction : frames) picked.frames[direction.frame] = std::move(direction);
}

namespace {

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
  return read_place(file, read_json<Json>(file), [&](const JsonPlace& place) {
    place.schema({kSchema});
    PickedGravity picked;
    read_fields(place, picked);
    if (picked.recording) expect_same(recording, *picked.recording);
    for (const auto& [index, direction] : picked.frames) expect_same(recording, direction);
    return picked;
  });
}

void write_picked_gravity(const fs::path& label_dir, const PickedGravity& picked) {
  const fs::path file = file_in(label_dir);
  std::error_code failed;
  if (picked.empty()) {
    fs::remove(file, failed);
    if (failed) throw Error(file.string() + ": cannot be removed: " + failed.message());
    return;
  }
  Json json = {{"schema", kSchema}};
  json.update(json_of(picked));
  fs::create_directories(label_dir, failed);
  if (failed) throw Error(label_dir.string() + ": cannot be made: " + failed.message());
  write_file_text(file, json_text(json, 2), Durable::yes);
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
