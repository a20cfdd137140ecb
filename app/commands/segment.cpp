// planescope segment: writes the planes of each frame to files.

#include "app/commands/segment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/commands.hpp"
#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/report_data.hpp"
#include "core/report/data/segment_files.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::app {
namespace {

using Json = nlohmann::ordered_json;

/// Summarizes a frame as one line and as JSON.
void summarize(const std::string& where,
               const planes::FrameResult& result,
               std::string& line,
               Json& json) {
  const planes::CloudCounts& counts = result.cloud.counts;
  const planes::Segmentation& found = result.segmentation;
  const Gravity& gravity = result.gravity;
  const auto in_plane =
      std::ranges::count_if(result.plane_of, [](std::int32_t id) { return id > 0; });
  const auto undecided = std::ranges::count_if(found.planes, &planes::PlaneRegion::undecided);
  line = fmt::format("{}: {}, {} of {} points in them", where,
                     counted(found.planes.size(), "plane"), in_plane, counts.kept);
  if (undecided > 0) line += fmt::format(", {} undecided", undecided);
  if (!found.minor.empty()) line += ", " + counted(found.minor.size(), "minor plane");
  if (counts.beyond_range > 0)
    line += fmt::format(", {} beyond the range (--max-range)", counts.beyond_range);
  if (counts.invalid > 0) line += fmt::format(", {} invalid", counts.invalid);
  if (counts.outside_cube > 0) line += fmt::format(", {} outside the cube", counts.outside_cube);
  line += fmt::format(", gravity {}", to_string(gravity.source));
  if (gravity.source == GravitySource::estimate || gravity.source == GravitySource::carried)
    line += fmt::format(" (confidence {:.2f})", gravity.confidence);
  if (!gravity.known()) line += ": planes are neither h nor v";
  json = {{"folder", where},           {"planes", found.planes.size()},
          {"undecided", undecided},    {"points", result.cloud.points.size()},
          {"kept", counts.kept},       {"beyond_range", counts.beyond_range},
          {"invalid", counts.invalid}, {"gravity_source", to_string(gravity.source)}};
}

/// Summary of a written frame.
struct WrittenFrame {
  std::string line, ros, refused;
  Json json;
  FrameMessages messages;  // if all frames go into one file
  bool unknown_gravity = false;
  std::size_t planes = 0;
};

WrittenFrame write_frame(const OpenInput& input,
                         int index,
                         const planes::PipelineOptions& options,
                         const planes::Classifier* classifier,
                         const SegmentArgs& args,
                         const world::KnownMap* map,
                         StagedOutput* output,
                         bool want_messages) {
  WrittenFrame written;
  try {
    const LoadedFrame loaded = run_input_frame(input, index, options, classifier, false);
    const std::filesystem::path folder = report::frame_folder(index);
    planes::FramePlanes found = planes::analyze_planes(loaded.frame, loaded.result, options);
    if (map) found.tracks = world::tracks_of(*map, index, found.summaries.size());
    if (output)
      report::write_segment_files(output->add(folder), loaded.frame, loaded.result, found, options,
                                  args.also);
    if (want_messages) written.messages = messages_of(loaded.frame, loaded.result, found, map);
    if (args.ros_json) written.ros = report::ros_json(loaded.frame, loaded.result, found);
    written.unknown_gravity = !loaded.result.gravity.known();
    written.planes = found.summaries.size();
    summarize(want_messages ? fmt::format("frame {}", index) : (args.out / folder).string(),
              loaded.result, written.line, written.json);
    if (want_messages) written.json["folder"] = nullptr;
    const bool has_foot = options.foot.radius_m > 0;
    const report::Terrain terrain = report::terrain_of(found, has_foot);
    const auto steppable = std::ranges::count_if(found.footholds, &planes::Foothold::steppable);
    if (has_foot) {
      written.line +=
          fmt::format("\n  steppable: {} of {}, {:.2f} m2 for the foot's center", steppable,
                      counted(found.footholds.size(), "plane"), terrain.steppable_area_m2);
      written.json["steppable"] = steppable;
      written.json["steppable_area_m2"] = terrain.steppable_area_m2;
    }
    if (const std::string stairs = terrain.text(); !stairs.empty()) written.line += "\n  " + stairs;
    written.line += "\n";
    written.json["flights"] = found.stairs.flights.size();
    written.json["kerbs"] = found.stairs.kerbs.size();
    written.json["ramps"] = found.stairs.ramps.size();
  } catch (const FrameRefused& refusal) {
    written.refused = refusal.what();
  }
  return written;
}

/// Whether frames come from standard input and are processed as they arrive. A map needs all
/// frames, so with --map they are read first.
bool is_live(const SegmentArgs& args) {
  return args.input.inputs == std::vector<std::filesystem::path>{"-"} && args.map.empty();
}

/// Formats a frame of a stream as one line of JSON.
std::string stream_line(int index, const Json& frame, const SegmentArgs& args) {
  Json line = {{"schema", "planescope.segment_frame/1"}, {"frame", index}};
  line.update(frame);
  if (args.out.empty()) line.erase("folder");
  return json_text(line, -1);
}

/// Removes output of an earlier run for frames that this run does not have.
void remove_earlier_frames(const std::filesystem::path& dir,
                           const std::set<std::filesystem::path>& frames,
                           StagedOutput& output) {
  std::vector<std::string> names = {"planes.json", "planes.png", "tracks.png", "cloud.ply",
                                    "timings.json"};
  for (const report::PlaneFormat& format : report::plane_formats()) names.push_back(format.file);
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(dir / "frames", absent)) {
    const std::filesystem::path frame = std::filesystem::path("frames") / entry.path().filename();
    if (frames.contains(frame)) continue;
    for (const std::string& name : names)
      if (std::filesystem::exists(dir / frame / name)) output.add_file(frame / name);
  }
}

}  // namespace

int run_segment(const SegmentArgs& args, std::stop_token stop, PlanesFile* file) {
  if (args.input.inputs.size() > 1)
    throw Error(fmt::format("segment: {} recordings; expected one", args.input.inputs.size()));
  std::optional<StagedOutput> output;
  std::optional<PlanesFile> own_file;
  const bool in_file = file || is_planes_file(args.out);
  if (!in_file && !args.out.empty()) output.emplace(args.out);
  InputArgs input_args = args.input;
  input_args.recording.color = in_file;
  input_args.recording.standard_input = true;
  std::shared_ptr<io::FrameStream> stream;  // null for a recording
  std::vector<OpenInput> inputs;
  if (is_live(args)) {
    stream = io::open_stream(0, input_args.recording, false);
    inputs.push_back({"-", stream, {}, args.input.label_dir.value_or("-.labels")});
  } else {
    inputs = open_inputs(input_args, args.out);
  }
  OpenInput& input = inputs.front();
  if (in_file && !file) file = &own_file.emplace(args.out);
  planes::PipelineOptions pipeline = args.input.pipeline;
  std::vector<std::string> lines, refused;
  std::shared_ptr<const world::KnownMap> map;
  if (!args.map.empty()) {
    map = world::read_known_map(args.map, input.recording->info(), pipeline);
    input.recording = world::with_map(input.recording, map);
    input.gravity = nullptr;  // use only the map's gravity
    pipeline = world::options_of_map(pipeline);
    std::erase_if(input.frames, [&](int frame) {
      if (map->knows(frame)) return false;
      refused.push_back(fmt::format("frame {}: not in the map {}", frame, args.map.string()));
      return true;
    });
  }
  const planes::ChosenClassifier chosen = choose_classifier(args.input.pipeline);

  bool unknown_gravity = false;
  Json json = {{"schema", "planescope.segment/1"},
               {"input", input.path.string()},
               {"out", args.out.string()},
               {"method", planes::to_string(args.input.pipeline.method)},
               {"frames", Json::array()}};
  const planes::FrameThreads threads =
      planes::threads_for_frames(pipeline, stream ? 1 : static_cast<int>(input.frames.size()));
  const auto write = [&](int index) {
    return naming_memory(input.name_of(index), [&] {
      return write_frame(input, index, threads.pipeline, chosen.classifier.get(), args, map.get(),
                         output ? &*output : nullptr, in_file);
    });
  };
  std::size_t written = 0, planes = 0;
  DamagedFrames damaged;
  std::set<std::filesystem::path> frames;
  const auto take = [&](int index, WrittenFrame&& frame) {
    if (!frame.refused.empty()) {
      if (stream) notice("rejected: {}", frame.refused);
      refused.push_back(frame.refused);
      return;
    }
    ++written;
    frames.insert(report::frame_folder(index));
    unknown_gravity |= frame.unknown_gravity;
    planes += frame.planes;
    if (in_file) file->add(frame.messages);
    if (args.ros_json || (stream && !args.quiet)) {  // print now, for programs that read the stream
      if (!args.ros_json && args.json) frame.line = stream_line(index, frame.json, args);
      fmt::print("{}", args.ros_json ? frame.ros + "\n" : frame.line);
      std::fflush(stdout);
    } else {
      lines.push_back(std::move(frame.line));
      json["frames"].push_back(std::move(frame.json));
    }
  };
  const FrameSlice& slice = args.input.frames;
  std::optional<Error> cut;  // ended the stream; the frames before it are delivered
  const auto arrives = [&] {
    try {
      return stream->wait_for_frame(stop);
    } catch (const Error& error) {
      cut = error;
      return false;
    }
  };
  if (stream) {
    for (int i = 0; !is_past_slice(slice, i) && arrives(); ++i)
      if (is_in_slice(slice, i)) take(i, write(i));
    if (stream->frame_count() == 0 && !cut && !stop.stop_requested())
      throw Error("standard input: no frames after the header");
  } else {
    damaged = run_frames(
        "segment", input.frames, threads.at_once, stop,
        [&](std::size_t i) { return write(input.frames[i]); },
        [&](std::size_t i, WrittenFrame&& frame) { take(input.frames[i], std::move(frame)); });
  }
  if (written == 0 && cut) throw *cut;
  if (written == 0 && !refused.empty()) throw Error(refused.front());
  if (written > 0 && planes == 0) warn(args.input, no_planes_text(input.path.string(), written));
  if (output && !stop.stop_requested()) remove_earlier_frames(args.out, frames, *output);
  if (output) output->commit();
  if (in_file && written > 0) file->commit();
  json["refused"] = refused;
  json["damaged"] = damaged.lines;
  if (!stream)
    for (const std::string& why : refused) notice("rejected: {}", why);
  if (args.json && !stream) fmt::print("{}", json_text(json, 2));
  if (!args.json && !args.ros_json && !args.quiet) fmt::print("{}", fmt::join(lines, ""));
  if (!args.json && unknown_gravity)
    notice("to distinguish h and v, {}", planes::kHowToGiveGravity);
  if (cut) throw *cut;
  if (stop.stop_requested()) throw Cancelled();
  const int code = damaged.report(input.frames.size());
  return args.map.empty() || refused.empty() ? code : 2;
}

void define_segment(CLI::App& app, Line& line) {
  CLI::App* segment =
      app.add_subcommand("segment",
                         "Find the planes of each frame\n"
                         "Writes planes.json, planes.png, cloud.ply, and timings.json for each "
                         "frame. Planes and clouds "
                         "are in the world frame: z up, meters. -o FILE.mcap "
                         "writes all frames and planes for Foxglove, RViz, and ros2 bag.");
  const auto args = std::make_shared<SegmentArgs>();
  add_inputs(segment, args->input,
             io::recordings_text(false) +
                 ", or - for frames on standard input; default: the sample recording");
  add_planes_out(segment, args->out);
  std::vector<std::string> formats;
  std::string holds;
  for (const report::PlaneFormat& format : report::plane_formats()) {
    formats.emplace_back(format.name);
    holds += fmt::format("\n{}: {}, {}", format.name, format.file, format.holds);
  }
  add(segment, "--also", args->also, "FORMAT,...", "Additional formats to write" + holds)
      ->check(some_of(formats, "an output format"));
  add(segment, "--map", args->map, "DIR",
      "Output of planescope map for the same frames and options: use the planes of the map, and "
      "add their tracks to planes.json and tracks.png");
  add_json(segment, args->json);
  segment->add_flag("--ros-json", args->ros_json,
                    "Print a line of JSON for each frame, with the fields of "
                    "planescope_msgs/PlaneArray; files are written only with -o");
  add_method(segment, args->input.pipeline);
  add_foot(segment, args->input.pipeline);
  const auto run = [](const SegmentArgs& given, std::stop_token stop) {
    return run_segment(given, std::move(stop));
  };
  runs(segment, line, args, run, [args] {
    if (is_planes_file(args->out) && !args->also.empty())
      throw Error("--also writes into the folder of -o DIR, but -o is a .mcap file");
    if (args->ros_json && args->json) throw Error("--ros-json cannot be combined with --json");
    if (!args->ros_json && args->out.empty() && !is_live(*args))
      throw Error(fmt::format("segment needs -o {}: {}", kPlanesOut, clause_of(kPlanesOutHelp)));
    if (args->out.empty() && !args->also.empty())
      throw Error("--also needs -o DIR, the folder to write to");
  });
}

}  // namespace planescope::app
