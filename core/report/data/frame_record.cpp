#include "core/report/data/frame_record.hpp"

#include <nlohmann/json.hpp>

#include "core/model/file_bytes.hpp"
#include "core/report/data/frame_json.hpp"
#include "core/report/data/report_files.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.report-frame/1";
constexpr const char* kFrame = "frame.json";
constexpr const char* kTimings = "timings.json";

ReportFrame read_record(const fs::path& dir, const Json& json) {
  ReportFrame frame = read_place(
      dir / kFrame, json, [](const JsonPlace& place) { return read_frame(place.at("frame")); });
  read_place(dir / kFrame, json, [&](const JsonPlace& place) {
    std::size_t k = 0;
    place.at("color_ids").each([&](const JsonPlace& id) {
      if (k < frame.planes.size()) frame.planes[k++].color_id = id.whole(0);
    });
  });
  const Json timings = read_json(dir / kTimings);
  read_place(dir / kTimings, timings, [&](const JsonPlace& place) { read_timings(place, frame); });
  return frame;
}

}  // namespace

void write_frame_record(const fs::path& dir,
                        const ReportFrame& frame,
                        bool ours,
                        const std::string& key) {
  const auto text = [](const Json& json) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  };
  write_file_text(dir / kTimings, text(timings_json(frame)));
  Json color_ids = Json::array();
  for (const ReportPlane& plane : frame.planes) color_ids.push_back(plane.color_id);
  write_file_text(dir / kFrame, text({{"schema", kSchema},
                                      {"key", key},
                                      {"color_ids", color_ids},
                                      {"frame", frame_json(frame, ours)}}));
}

std::optional<ReportFrame> find_frame_record(const fs::path& dir, const std::string& key) {
  if (!fs::exists(dir / kFrame)) return std::nullopt;
  const Json json = read_json(dir / kFrame);
  const bool is_it = read_place(dir / kFrame, json, [&](const JsonPlace& place) {
    return place.at("schema").text() == kSchema && place.at("key").text() == key;
  });
  if (!is_it || key.empty()) return std::nullopt;
  return read_record(dir, json);
}

ReportFrame read_frame_record(const fs::path& dir) {
  const Json json = read_json(dir / kFrame);
  read_place(dir / kFrame, json, [](const JsonPlace& place) {
    if (place.at("schema").text() != kSchema) place.at("schema").fail_kind(kSchema);
  });
  return read_record(dir, json);
}

}  // namespace planescope::report
