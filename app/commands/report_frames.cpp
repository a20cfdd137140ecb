// Processes and writes the frames of a report on all cores, including shards and resumed runs.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/cli/output.hpp"
#include "app/cli/progress.hpp"
#include "app/commands/report.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/report/data/segment_files.hpp"
#include "render/palette.hpp"
#include "render/plane_colors.hpp"
#include "render/renderer.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

/// Draws on the thread that created it; `error` explains why if that is not possible.
struct Painter {
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  std::string description, error;

  explicit Painter(bool wanted) {
    if (!wanted) return;
    try {
      context = render::make_egl_context();
      description = context->description();
      renderer = std::make_unique<render::Renderer>();
    } catch (const Error& failure) {
      give_up(failure);
    }
  }
  ~Painter() { renderer.reset(); }  // before its context
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  void give_up(const Error& failure) {
    error = failure.what();
    renderer.reset();
  }
};

/// Colors of planes continue those of the previous frame in the recording, so frames that run in
/// parallel wait here for their turn.
class ColorChain {
 public:
  explicit ColorChain(std::size_t inputs) : before_(inputs), next_(inputs, 0) {}

  /// Sets the colors of the planes; false if the chain was broken off. `turn` counts the input's
  /// slots. `image` shows the same planes; it is empty for a refused frame, which later frames
  /// skip.
  bool follow(std::size_t input,
              int turn,
              std::optional<render::PlaneImage> image,
              std::vector<report::ReportPlane>& planes) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return broken_ || next_[input] == turn; });
    if (broken_) return false;
    if (image) {
      std::optional<render::ColoredPlanes>& before = before_[input];
      before = render::color_planes(std::move(*image), before ? &*before : nullptr);
      for (std::size_t k = 0; k < planes.size(); ++k) {
        planes[k].color_id = before->colors[k];
        planes[k].color = css_color(render::plane_color(before->colors[k]));
      }
    }
    ++next_[input];
    changed_.notify_all();
    return true;
  }
  void break_off() {
    const std::lock_guard lock(mutex_);
    broken_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::optional<render::ColoredPlanes>> before_;
  std::vector<int> next_;
  bool broken_ = false;
};

/// Times a fixed amount of work, to compare times across machines [ms].
double reference_work() {
  const auto started = std::chrono::steady_clock::now();
  Random random(1);
  std::vector<double> values(60'000);
  for (double& value : values) value = random.uniform();
  std::ranges::sort(values);
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - started;
  return values.front() <= values.back() ? time.count() : 0;
}

/// Hash key of everything that determines a frame's result. `sha256` is Recording::frame_hash(),
/// which reads the frame again.
std::string key_of(const ReportFramesJob& job,
                   const OpenInput& input,
                   const Frame& frame,
                   const std::string& sha256) {
  const int index = frame.index;
  const Intrinsics& k = frame.intrinsics;
  std::string text =
      fmt::format("{}\n{}\n{} {} {} {} {} {}", job.build_key, sha256, frame.depth_unit_m, k.fx,
                  k.fy, k.cx, k.cy, static_cast<int>(k.distortion));
  for (const double coefficient : k.coefficients) text += fmt::format(" {}", coefficient);
  if (frame.gravity) {
    const Vec3d& g = frame.gravity->direction;
    text += fmt::format("\n{} {} {} {}", g.x(), g.y(), g.z(), to_string(frame.gravity->source));
  }
  const auto add_hash = [&text](const auto& values) {
    text.append(1, '\n').append(sha256_hex(std::as_bytes(std::span(values))));
  };
  add_hash(frame.color.data);
  if (frame.cloud) {
    add_hash(frame.cloud->label);
    add_hash(frame.cloud->instance);
  }
  if (const std::optional<int> number = input.label_number(index))
    for (const fs::path& file : labels::label_file_paths(input.label_dir, *number))
      if (fs::is_regular_file(file)) text.append(1, '\n').append(sha256_hex_of_file(file));
  return sha256_hex(text);
}

class FrameWriter {
 public:
  FrameWriter(const ReportFramesJob& job, ReportFolder& folder, ColorChain& chain, Painter& painter)
      : job_(job), folder_(folder), chain_(chain), painter_(painter) {}

  /// False if the chain of colors was broken off.
  bool write(ReportSlot& slot, int turn) {
    const OpenInput& input = job_.inputs[slot.input];
    std::optional<report::ReportFrame> found;
    if (job_.resume && folder_.has(slot.folder)) found = find(input, slot);
    report::ReportFrame frame;
    std::optional<LoadedFrame> loaded;
    const double reference_ms = reference_work();
    const auto unless_refused = [&](const auto& work) {
      try {
        work();
      } catch (const Error& error) {
        loaded.reset();
        frame = refused(input, slot.index, error);
      }
      frame.reference_ms = reference_ms;
    };
    unless_refused([&] {  // run finished frames too: later frames continue their colors
      loaded = job_.run(input, slot.index, job_.options, job_.classifier);
      if (found && found->planes.size() != loaded->result.segmentation.planes.size()) found.reset();
      if (!slot.colors_only && !found) frame = described(input, slot.index, *loaded);
    });
    std::optional<render::PlaneImage> image;
    if (loaded) image = render::plane_image(loaded->result);
    const std::vector<int> colors = found ? colors_of(found->planes) : std::vector<int>();
    if (!chain_.follow(slot.input, turn, std::move(image), found ? found->planes : frame.planes))
      return false;
    if (found) {
      // Colors differ if an earlier frame changed, for example because it was refused in the
      // earlier run.
      slot.found = colors_of(found->planes) == colors;
      if (slot.found) return true;
      if (loaded) unless_refused([&] { frame = described(input, slot.index, *loaded); });
      take_colors(frame.planes, found->planes);
    }
    if (!slot.colors_only) put_down(slot, frame, loaded ? &*loaded : nullptr);
    return true;
  }

 private:
  report::ReportFrame described(const OpenInput& input, int index, const LoadedFrame& loaded) {
    report::ReportFrame frame = report::make_report_frame(
        loaded.frame, loaded.result,
        planes::analyze_planes(loaded.frame, loaded.result, job_.options), job_.options);
    frame.histograms =
        report::decision_histograms(loaded.result.segmentation, loaded.limit_ratios,
                                    planes::segment_options(loaded.result, job_.options));
    if (loaded.truth) frame.metrics = planes::score_frame(loaded.result, *loaded.truth);
    frame.sha256 = input.recording->frame_hash(index);
    return frame;
  }

  std::optional<report::ReportFrame> find(const OpenInput& input, const ReportSlot& slot) {
    try {
      return folder_.find(slot.folder, key_of(job_, input, input.frame(slot.index),
                                              input.recording->frame_hash(slot.index)));
    } catch (const Error&) {
      return std::nullopt;  // damaged: run it again
    }
  }

  static std::vector<int> colors_of(const std::vector<report::ReportPlane>& planes) {
    std::vector<int> colors;
    for (const report::ReportPlane& plane : planes) colors.push_back(plane.color_id);
    return colors;
  }

  /// Copies colors between the same planes; the counts differ if the frame could not be run again.
  static void take_colors(std::vector<report::ReportPlane>& planes,
                          const std::vector<report::ReportPlane>& colored) {
    for (std::size_t k = 0; k < std::min(planes.size(), colored.size()); ++k) {
      planes[k].color_id = colored[k].color_id;
      planes[k].color = colored[k].color;
    }
  }

  static report::ReportFrame refused(const OpenInput& input, int index, const Error& error) {
    report::ReportFrame frame;
    frame.index = index;
    frame.refused = error.what();
    frame.unreadable = dynamic_cast<const FrameRefused*>(&error) == nullptr;
    try {
      frame.name = input.recording->frame(index).name;
      frame.sha256 = input.recording->frame_hash(index);
    } catch (const Error&) {
      frame.unreadable = true;
    }
    return frame;
  }

  void put_down(const ReportSlot& slot, report::ReportFrame& frame, const LoadedFrame* loaded) {
    const fs::path place = folder_.start(slot.folder);
    std::string key;
    if (loaded) {
      PictureJob job;
      job.dir = place;
      job.relative = slot.folder;
      job.copy_width = job_.copy_width;
      job.max_range_m = job_.options.cloud.max_range_m;
      job.method = job_.options.method;
      if (job_.pictures) frame.pictures = draw(*loaded, frame, job);
      // A frame without pictures is unfinished for a run that can draw.
      if (painter_.renderer || !job_.pictures)
        key = key_of(job_, job_.inputs[slot.input], loaded->frame, frame.sha256);
    }
    folder_.finish(slot.folder, frame, job_.options.method == planes::Method::ours, key);
  }

  std::vector<report::ReportPicture> draw(const LoadedFrame& loaded,
                                          const report::ReportFrame& frame,
                                          const PictureJob& job) {
    const std::vector<int> colors = colors_of(frame.planes);
    if (painter_.renderer) {
      try {
        return draw_pictures(loaded, colors, painter_.renderer.get(), job);
      } catch (const DrawingFailed& failure) {
        painter_.give_up(failure);
        folder_.start(job.relative);  // start over
      }
    }
    return draw_pictures(loaded, colors, nullptr, job);
  }

  const ReportFramesJob& job_;
  ReportFolder& folder_;
  ColorChain& chain_;
  Painter& painter_;
};

/// Text as written to report.json, which later reports compare with.
std::string as_utf8(const std::string& text) {
  using nlohmann::json;
  const std::string written = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  return json::parse(written).get<std::string>();
}

}  // namespace

std::vector<std::string> recording_names(const std::vector<OpenInput>& inputs) {
  std::vector<fs::path> paths;
  std::vector<std::string> last, names;
  for (const OpenInput& input : inputs) {
    paths.push_back(without_slash(fs::absolute(input.path).lexically_normal()));
    last.push_back(as_utf8(paths.back().filename().string()));
    if (last.back().empty()) last.back() = "recording";
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    std::string name = last[i];
    if (std::ranges::count(last, name) > 1)
      name = fmt::format("{}-{}", as_utf8(paths[i].parent_path().filename().string()), name);
    const std::string once = name;
    for (int n = 2; std::ranges::count(names, name) > 0; ++n) name = fmt::format("{}-{}", once, n);
    names.push_back(name);
  }
  return names;
}

fs::path report_frame_folder(std::size_t recordings,
                             std::size_t recording,
                             const std::string& name,
                             int index) {
  if (recordings == 1) return report::frame_folder(index);
  return fmt::format("{:02}-{}", recording + 1, name) / report::frame_folder(index);
}

Shard parse_shard(const std::string& text) {
  const std::vector<std::string> parts = split(text, '/');
  if (parts.size() != 2) throw Error("--shard '" + text + "' is not I/N, such as 2/8");
  Shard shard;
  shard.index = parse_integer(parts[0], "--shard " + text);
  shard.count = parse_integer(parts[1], "--shard " + text);
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count)
    throw Error("--shard " + text + " is out of range; expected I/N with I from 1 to N");
  return shard;
}

std::vector<ReportSlot> report_slots(const std::vector<OpenInput>& inputs, const Shard& shard) {
  std::int64_t total = 0;
  for (const OpenInput& input : inputs) total += static_cast<std::int64_t>(input.frames.size());
  const std::int64_t first = total * (shard.index - 1) / shard.count;
  const std::int64_t end = total * shard.index / shard.count;
  const std::vector<std::string> names = recording_names(inputs);
  std::vector<ReportSlot> slots;
  std::int64_t at = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::int64_t end_of_input = at + static_cast<std::int64_t>(inputs[i].frames.size());
    for (const int index : inputs[i].frames) {
      ReportSlot slot;
      slot.input = i;
      slot.index = index;
      slot.folder = report_frame_folder(inputs.size(), i, names[i], index);
      slot.colors_only = at < first;
      if (at < end && end_of_input > first) slots.push_back(std::move(slot));
      ++at;
    }
  }
  return slots;
}

LoadedFrame run_report_frame(const OpenInput& input,
                             int index,
                             const planes::PipelineOptions& options,
                             const planes::Classifier* classifier) {
  planes::Trace trace;
  LoadedFrame loaded = run_input_frame(input, index, options, classifier, true, &trace);
  loaded.limit_ratios = std::move(trace.limit_ratios);
  return loaded;
}

ReportDrawing write_report_frames(const ReportFramesJob& job,
                                  ReportFolder& folder,
                                  std::vector<ReportSlot>& slots,
                                  const std::stop_token& stop) {
  std::vector<int> turns, of_input(job.inputs.size(), 0);
  for (const ReportSlot& slot : slots) turns.push_back(of_input[slot.input]++);
  const int count = static_cast<int>(slots.size());
  const planes::FrameThreads threads = planes::threads_for_frames(job.options, count);
  ReportFramesJob one = job;
  one.options = threads.pipeline;
  // Mesa's software renderer rasterizes one frame at a time, whichever thread asks. With its own
  // threads, no core is idle while other frames wait for it.
  ::setenv("LP_NUM_THREADS",
           std::to_string(job.options.threads > 1 ? job.options.threads : 0).c_str(), 0);

  ColorChain chain(job.inputs.size());
  ReportDrawing drawing;
  std::mutex mutex;
  Progress progress("report", count);
  const auto make_body = [&] {
    const auto painter = std::make_shared<Painter>(job.pictures);
    const std::lock_guard lock(mutex);
    if (drawing.renderer.empty()) drawing.renderer = painter->description;
    return [&, painter](int i) {
      ReportSlot& slot = slots[static_cast<std::size_t>(i)];
      if (stop.stop_requested()) return chain.break_off();
      try {
        slot.done = FrameWriter(one, folder, chain, *painter)
                        .write(slot, turns[static_cast<std::size_t>(i)]);
      } catch (...) {
        chain.break_off();
        throw;
      }
      const std::lock_guard guard(mutex);
      if (drawing.error.empty()) drawing.error = painter->error;
    };
  };
  work_through_with(count, threads.at_once, make_body,
                    [&](int done, int) { progress.show(done, fmt::format("{} frames", done)); });
  return drawing;
}

}  // namespace planescope::app
