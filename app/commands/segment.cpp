#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/segment_files.hpp"
#include "core/report/data/report_data.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::app {
namespace {

struct SegmentArgs {
  InputArgs input;            // one recording
  std::filesystem::path out;  // -o; empty: nothing is written
  std::vector<std::string> also;
  std::filesystem::path map;  // --map; empty: none
  bool json = false, ros_json = false;
};

// The one line that tells what became of a frame.
std::string line_of(const std::string& folder, const planes::FrameResult& result) {
  const planes::CloudCounts& counts = result.cloud.counts;
  std::size_t in_plane = 0;
  for (const std::int32_t id : result.plane_of) in_plane += id > 0;
  std::string line =
      fmt::format("{}: {}, {} of {} points in them", folder,
                  counted(result.segmentation.planes.size(), "plane"), in_plane, counts.kept);
  const auto undecided =
      std::ranges::count_if(result.segmentation.planes, &planes::PlaneRegion::undecided);
  if (undecided > 0) line += fmt::format(", {} undecided", undecided);
  if (!result.segmentation.minor.empty())
    line += ", " + counted(result.segmentation.minor.size(), "minor plane");
  if (counts.beyond_range > 0)
    line += fmt::format(", {} beyond the range (--max-range)", counts.beyond_range);
  if (counts.invalid > 0) line += fmt::format(", {} invalid", counts.invalid);
  if (counts.outside_cube > 0) line += fmt::format(", {} outside the cube", counts.outside_cube);
  const Gravity& gravity = result.gravity;
  line += fmt::format(", gravity {}", to_string(gravity.source));
  if (gravity.source == GravitySource::estimate || gravity.source == GravitySource::carried)
    line += fmt::format(" (confidence {:.2f})", gravity.confidence);
  if (!gravity.known()) line += ": planes are neither h nor v";
  return line;
}

nlohmann::ordered_json frame_json(const std::string& folder, const planes::FrameResult& result) {
  nlohmann::ordered_json json;
  json["folder"] = folder;
  json["planes"] = result.segmentation.planes.size();
  json["undecided"] =
      std::ranges::count_if(result.segmentation.planes, &planes::PlaneRegion::undecided);
  json["points"] = result.cloud.points.size();
  json["kept"] = result.cloud.counts.kept;
  json["beyond_range"] = result.cloud.counts.beyond_range;
  json["invalid"] = result.cloud.counts.invalid;
  json["gravity_source"] = to_string(result.gravity.source);
  return json;
}

/// What is told of a frame: empty where it was not begun.
struct WrittenFrame {
  std::string line, ros, refused;
  nlohmann::ordered_json json;
  bool unknown_gravity = false;
};

WrittenFrame write_frame(const OpenInput& input,
                         int index,
                         const planes::PipelineOptions& options,
                         const planes::Classifier* classifier,
                         const SegmentArgs& args,
                         const world::KnownMap* map,
                         StagedOutput* output) {
  WrittenFrame written;
  const std::filesystem::path& out = args.out;
  try {
    const LoadedFrame loaded = run_input_frame(input, index, options, classifier, false);
    const std::filesystem::path folder = report::frame_folder(index);
    planes::FramePlanes found = planes::analyze_planes(loaded.frame, loaded.result, options);
    if (map) found.tracks = world::tracks_of(*map, index, found.summaries.size());
    if (output)
      report::write_segment_files(output->add(folder), loaded.frame, loaded.result, found, options,
                                  args.also);
    if (args.ros_json) written.ros = report::ros_json(loaded.frame, loaded.result, found);
    written.unknown_gravity = !loaded.result.gravity.known();
    written.line = line_of((out / folder).string(), loaded.result);
    const bool has_foot = options.foot.radius_m > 0;
    const report::Terrain terrain = report::terrain_of(found, has_foot);
    const auto steppable = std::ranges::count_if(found.footholds, &planes::Foothold::steppable);
    written.json = frame_json((out / folder).string(), loaded.result);
    if (has_foot) {
      written.line +=
          fmt::format("\n  steppable: {} of {}, {:.2f} m2 for the foot's centre", steppable,
                      counted(found.footholds.size(), "plane"), terrain.steppable_area_m2);
      written.json["steppable"] = steppable;
      written.json["steppable_area_m2"] = terrain.steppable_area_m2;
    }
    if (const std::string stairs = terrain.text(); !stairs.empty()) written.line += "\n  " + stairs;
    written.json["flights"] = found.stairs.flights.size();
    written.json["kerbs"] = found.stairs.kerbs.size();
    written.json["ramps"] = found.stairs.ramps.size();
  } catch (const FrameRefused& refusal) {
    written.refused = refusal.what();
  }
  return written;
}

/// Writes DIR/frames/000000/{planes.json,timings.json,planes.png,cloud.ply}, with --map tracks.png,
/// for each frame. All or nothing on an Error; the frames done so far, and Cancelled, on a stop.
/// Returns the exit code.
int run_segment(const SegmentArgs& args, std::stop_token stop) {
  if (args.input.inputs.size() > 1)
    throw Error(fmt::format("segment takes one recording, {} are given", args.input.inputs.size()));
  std::optional<StagedOutput> output;
  if (!args.out.empty()) output.emplace(args.out);
  InputArgs depth_alone = args.input;
  depth_alone.recording.color = false;
  std::vector<OpenInput> inputs = open_inputs(depth_alone);
  OpenInput& input = inputs.front();
  planes::PipelineOptions pipeline = args.input.pipeline;
  std::vector<std::string> lines, refused;
  std::shared_ptr<const world::KnownMap> map;
  if (!args.map.empty()) {
    map = world::read_known_map(args.map, input.recording->info(), pipeline);
    input.recording = world::with_map(input.recording, map);
    input.gravity = nullptr;  // the map's, or none
    pipeline = world::options_of_map(pipeline);
    std::erase_if(input.frames, [&](int frame) {
      if (map->knows(frame)) return false;
      refused.push_back(fmt::format("frame {}: is not in the map {}", frame, args.map.string()));
      return true;
    });
  }
  const planes::ChosenClassifier chosen = choose_classifier(args.input.pipeline);

  bool unknown_gravity = false;
  nlohmann::ordered_json json;
  json["schema"] = "planescope.segment/1";
  json["input"] = input.path.string();
  json["out"] = args.out.string();
  json["method"] = planes::to_string(args.input.pipeline.method);
  json["frames"] = nlohmann::ordered_json::array();
  {
    const int count = static_cast<int>(input.frames.size());
    const planes::FrameThreads threads = planes::threads_for_frames(pipeline, count);
    std::vector<WrittenFrame> written(input.frames.size());
    Progress progress("segment", count);
    const auto make = [&](int i) {
      if (!stop.stop_requested())
        written[i] = write_frame(input, input.frames[i], threads.pipeline, chosen.classifier.get(),
                                 args, map.get(), output ? &*output : nullptr);
    };
    const auto take = [&](int i) {
      WrittenFrame& frame = written[i];
      progress.show(i + 1, fmt::format("frame {}", input.frames[i]));
      if (!frame.refused.empty()) refused.push_back(frame.refused);
      if (frame.line.empty()) return;
      if (args.ros_json) {  // for whoever reads along
        fmt::print("{}\n", frame.ros);
        std::fflush(stdout);
      }
      unknown_gravity |= frame.unknown_gravity;
      lines.push_back(std::move(frame.line));
      json["frames"].push_back(std::move(frame.json));
    };
    work_in_order(count, threads.at_once, make, take);
  }
  if (lines.empty() && !refused.empty()) throw Error(refused.front());
  if (output) output->commit();
  json["refused"] = refused;
  for (const std::string& why : refused) notice("refused: {}", why);
  if (args.ros_json) {
    if (unknown_gravity) notice("to tell h from v, {}", planes::kHowToGiveGravity);
  } else if (args.json) {
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    for (const std::string& line : lines) fmt::print("{}\n", line);
    if (unknown_gravity) notice("to tell h from v, {}", planes::kHowToGiveGravity);
  }
  if (stop.stop_requested()) throw Cancelled();
  return 0;
}

}  // namespace

void define_segment(CLI::App& app, Line& line) {
  CLI::App* segment = app.add_subcommand(
      "segment",
      "Find the planes of each frame: planes.json, planes.png, cloud.ply, timings.json.\n"
      "Planes and cloud.ply are in the world frame: z up, metres.");
  const auto args = std::make_shared<SegmentArgs>();
  add_inputs(segment, args->input, io::recordings_text(false));
  add_out(segment, args->out);
  std::vector<std::string> formats;
  std::string holds;
  for (const report::PlaneFormat& format : report::plane_formats()) {
    formats.emplace_back(format.name);
    holds += fmt::format("; {}: {}, {}", format.name, format.file, format.holds);
  }
  add(segment, "--also", args->also, "FORMAT,...", "Also write" + holds.substr(1))
      ->check(some_of(formats, "a format"));
  add(segment, "--map", args->map, "DIR",
      "Where planescope map wrote the map of the same frames with the same options: planes are "
      "those of the map, and planes.json and tracks.png tell their tracks");
  add_json(segment, args->json);
  segment->add_flag("--ros-json", args->ros_json,
                    wrapped("Print each frame's planes as a line of JSON, which has the fields of "
                            "planescope_msgs/PlaneArray; nothing is written without -o"));
  add_method(segment, args->input.pipeline);
  add_foot(segment, args->input.pipeline);
  runs(segment, line, args, run_segment, [args] {
    if (args->ros_json && args->json) throw Error("--ros-json: is instead of --json");
    if (args->ros_json && args->out.empty() && !args->also.empty())
      throw Error("--also: writes into the folder of -o DIR, which is not given");
    if (!args->ros_json && args->out.empty()) throw Error("segment needs -o DIR: Output folder");
  });
}

}  // namespace planescope::app
