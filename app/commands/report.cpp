#include "app/commands/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "app/commands/report_pictures.hpp"
#include "app/output.hpp"
#include "app/progress.hpp"
#include "core/base/error.hpp"
#include "core/base/sha256.hpp"
#include "core/pipeline/score.hpp"
#include "core/report/build_info.hpp"
#include "core/report/report_data.hpp"
#include "core/report/report_files.hpp"
#include "core/report/segment_files.hpp"
#include "render/context.hpp"
#include "render/palette.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;

std::string name_of(const fs::path& path) {
  const fs::path trimmed = path.has_filename() ? path : path.parent_path();
  const std::string name = fs::absolute(trimmed).lexically_normal().filename().string();
  return name.empty() ? path.string() : name;
}

std::string now_utc() {
  const auto now =
      std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now.time_since_epoch().count()));
}

/// Draws where that is possible; where it is not, says why and the report goes on without.
struct Painter {
  std::unique_ptr<GlContext> context;
  std::unique_ptr<Renderer> renderer;
  std::string description, error;

  Painter() {
    try {
      context = make_egl_context();
      description = context->description();
      renderer = std::make_unique<Renderer>();
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

/// Colour ids of a frame's planes that follow those of the frame before.
std::vector<int> next_colors(const FrameResult& result, std::vector<ColoredPlane>& before) {
  std::vector<ColoredPlane> now;
  for (const PlaneRegion& plane : result.segmentation.planes) {
    const Vec3d centroid = plane.fit.centroid + result.cloud.origin;
    now.push_back({plane.label, plane.fit.normal, plane.fit.normal.dot(centroid), centroid, 0});
  }
  keep_colors(before, now);
  before = now;
  std::vector<int> colors;
  for (const ColoredPlane& plane : now) colors.push_back(plane.color_id);
  return colors;
}

/// Smaller copies in the page of a long recording, so that a browser still opens it.
int copy_width(int frames) { return frames <= 8 ? 1280 : frames <= 24 ? 800 : 560; }

Report start_report(const ReportArgs& args,
                    const std::vector<OpenInput>& inputs,
                    const ChosenClassifier& chosen) {
  Report report;
  const BuildInfo build = build_info();
  report.version = build.version;
  report.commit = build.commit;
  report.modified = build.modified;
  report.command = args.command;
  report.created_utc = now_utc();
  report.method = args.input.pipeline.method;
  if (report.method == Method::ours) report.classifier = args.input.pipeline.classifier;
  report.weights = chosen.weights;
  report.options = make_report_options(args.input.pipeline);
  for (const Case c : {Case::I, Case::II, Case::III, Case::IV})
    report.case_colors[static_cast<int>(c)] = css_color(case_color(c));
  for (const OpenInput& input : inputs) {
    ReportRecording recording;
    recording.info = input.recording->info();
    recording.info.path = input.path;
    recording.name = name_of(input.path);
    if (fs::is_regular_file(input.path)) recording.sha256 = sha256_hex_of_file(input.path);
    recording.frame_count = input.recording->frame_count();
    recording.frames_asked = static_cast<int>(input.frames.size());
    report.recordings.push_back(std::move(recording));
  }
  return report;
}

class ReportRun {
 public:
  ReportRun(const ReportArgs& args, std::stop_token stop)
      : args_(args),
        stop_(std::move(stop)),
        output_(args.out),
        inputs_(open_inputs(args.input)),
        chosen_(choose_classifier(args.input.pipeline)) {
    for (const OpenInput& input : inputs_) total_ += static_cast<int>(input.frames.size());
  }

  int run() {
    // Damaged input is found before anything is written.
    std::vector<std::vector<std::string>> hashes = read_all_once();
    report_ = start_report(args_, inputs_, chosen_);
    {
      Progress progress("report", total_);
      int done = 0;
      for (std::size_t i = 0; i < inputs_.size() && !report_.partial; ++i)
        run_recording(i, hashes[i], progress, done);
    }
    refuse_if_nothing_was_done();
    report_.renderer = painter_.error.empty() ? painter_.description : "";
    report_.renderer_error = painter_.error;
    output_.commit();
    fs::create_directories(args_.out);
    write_report_files(args_.out, report_);
    if (report_.partial) throw Cancelled();
    tell();
    return painter_.error.empty() ? 0 : 3;
  }

 private:
  std::vector<std::vector<std::string>> read_all_once() {
    std::vector<std::vector<std::string>> hashes;
    Progress progress("reading", total_);
    int done = 0;
    for (const OpenInput& input : inputs_) {
      hashes.emplace_back();
      for (const int index : input.frames) {
        if (stop_.stop_requested()) throw Cancelled();
        progress.show(done++, input.path.filename().string());
        input.recording->frame(index);
        hashes.back().push_back(input.recording->frame_hash(index));
      }
    }
    return hashes;
  }

  void run_recording(std::size_t i,
                     const std::vector<std::string>& hashes,
                     Progress& progress,
                     int& done) {
    ReportRecording& recording = report_.recordings[i];
    std::vector<ColoredPlane> colors;
    for (std::size_t k = 0; k < inputs_[i].frames.size(); ++k) {
      if (stop_.stop_requested()) {
        report_.partial = true;
        return;
      }
      const int index = inputs_[i].frames[k];
      progress.show(done++, fmt::format("{} frame {}", recording.name, index));
      recording.frames.push_back(run_frame_of(i, index, colors));
      recording.frames.back().sha256 = hashes[k];
    }
  }

  ReportFrame run_frame_of(std::size_t i, int index, std::vector<ColoredPlane>& before) {
    const PipelineOptions& options = args_.input.pipeline;
    LoadedFrame loaded;
    try {
      loaded = run_input_frame(inputs_[i], index, options, chosen_.classifier.get(), true);
    } catch (const FrameRefused& refusal) {
      if (first_refusal_.empty()) first_refusal_ = refusal.what();
      ReportFrame refused;
      refused.index = index;
      refused.refused = refusal.what();
      return refused;
    }
    const std::vector<int> colors = next_colors(loaded.result, before);
    std::vector<std::string> css;
    for (const int id : colors) css.push_back(css_color(plane_color(id)));
    ReportFrame frame = make_report_frame(loaded.frame, loaded.result, options, css);
    if (loaded.truth) frame.metrics = score_frame(loaded.result, *loaded.truth);

    PictureJob job;
    if (inputs_.size() > 1)
      job.relative = fmt::format("{:02}-{}", i + 1, report_.recordings[i].name);
    job.relative /= frame_folder(index) / "pictures";
    job.dir = output_.add(job.relative);
    job.copy_width = copy_width(total_);
    job.max_range_m = options.cloud.max_range_m;
    job.method = options.method;
    frame.pictures = draw(loaded, colors, job);
    return frame;
  }

  std::vector<ReportPicture> draw(const LoadedFrame& loaded,
                                  const std::vector<int>& colors,
                                  const PictureJob& job) {
    if (painter_.renderer) {
      try {
        return draw_pictures(loaded, colors, painter_.renderer.get(), job);
      } catch (const Error& failure) {
        painter_.give_up(failure);
      }
    }
    return draw_pictures(loaded, colors, nullptr, job);
  }

  /// A recording that gives nothing at all is bad input, not a report.
  void refuse_if_nothing_was_done() {
    if (!report_.partial && totals_of(report_).frames_done == 0) throw Error(first_refusal_);
  }

  void tell() {
    const ReportTotals totals = totals_of(report_);
    const std::string page = (args_.out / "index.html").string();
    if (args_.json) {
      nlohmann::ordered_json json = {
          {"schema", "planescope/report-written/1"}, {"page", page},
          {"recordings", totals.recordings},         {"frames_done", totals.frames_done},
          {"frames_refused", totals.frames_refused}, {"planes", totals.planes},
          {"rendered", painter_.error.empty()}};
      fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
      fmt::print("{}: {} frames, {} planes\n", page, totals.frames_done, totals.planes);
    }
    if (totals.frames_refused > 0)
      fmt::print(stderr, "planescope: warning: {} frames were refused, the first: {}\n",
                 totals.frames_refused, first_refusal_);
    if (!painter_.error.empty())
      fmt::print(stderr, "planescope: rendering failed, the data files are written: {}\n",
                 painter_.error);
  }

  const ReportArgs& args_;
  std::stop_token stop_;
  StagedOutput output_;
  std::vector<OpenInput> inputs_;
  ChosenClassifier chosen_;
  int total_ = 0;  // frames asked for
  Painter painter_;
  Report report_;
  std::string first_refusal_;
};

}  // namespace

int run_report(const ReportArgs& args, std::stop_token stop) {
  return ReportRun(args, std::move(stop)).run();
}

}  // namespace planescope
