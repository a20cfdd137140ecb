// Fuzz targets for documents and texts (weights, reports, rules, filters, options), and for the
// method on arbitrary frames.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/debug/filter/filter.hpp"
#include "core/io/byte_reader.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/lab/tuning/tuning_trials.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/compare/rules.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/data/report_json.hpp"
#include "fuzz/fuzz.hpp"
#include "unit/debug/replay/replay_subject.hpp"

namespace planescope::fuzz {
namespace {

namespace fs = std::filesystem;

void read_json(Bytes bytes) {
  const std::string text = text_of(bytes);
  parse_json<nlohmann::json>(text, "a");
  parse_json<nlohmann::ordered_json>(text, "a");
}

void read_weights(Bytes bytes) {
  const planes::NetworkWeights weights =
      planes::read_weights(file_of("weights/a.safetensors", bytes));
  const fs::path again = memory_folder() / "weights" / "again.safetensors";
  planes::write_weights(again, weights);
  require(planes::read_weights(again).tensors == weights.tensors, "weights that change");
}

/// Compares a report with itself, evaluates and writes it, as `planescope compare` and `report` do.
void read_report(Bytes bytes) {
  const fs::path path = file_of("report/report.json", bytes);
  const report::Report read = report::read_report(path);
  const auto comparison = report::compare_reports(read, read);
  report::broken_rules(report::built_in_rules(), comparison);
  report::idle_rules(report::built_in_rules(), comparison, true);
  report::frames_csv(read);
  report::junit_xml(read);
  report::read_report_head(path);
}

void read_frame_record(Bytes bytes) {
  const fs::path dir = file_of("frame_record/frame.json", bytes).parent_path();
  if (!fs::exists(dir / "timings.json")) {
    report::write_frame_record(dir, {}, true, "key");
    file_of("frame_record/frame.json", bytes);
  }
  report::read_frame_record(dir);
}

void read_rules(Bytes bytes) {
  const auto rules = report::read_rules(file_of("rules/planescope.rules.json", bytes));
  const std::string text = report::rules_json(rules);
  const auto again =
      report::read_rules(file_of("rules/again.json", ByteVector(text.begin(), text.end())));
  require(again == rules, "rules that change when they are written and read");
}

void read_profile(Bytes bytes) {
  const fs::path path = file_of("profile/a.json", bytes);
  planes::PipelineOptions options;
  planes::set_profile(options, path.string());
  const std::string text = planes::profile_text(planes::read_profile(path));
  planes::PipelineOptions again;
  planes::set_profile(again,
                      file_of("profile/again.json", ByteVector(text.begin(), text.end())).string());
  for (const planes::OptionInfo& info : planes::option_table())
    require(info.get(again) == info.get(options), "a profile that changes: " + info.name);
}

/// The journal of a search, which a rerun resumes.
void read_tuning_journal(Bytes bytes) {
  const lab::TuningPurpose purpose = {{"frames or labels", "f"}, {"options", "o"}};
  fs::remove_all(memory_folder() / "tuning_journal");
  const fs::path path = file_of("tuning_journal/journal.jsonl", bytes);
  lab::TuningJournal journal(path.parent_path(), purpose);
  const std::size_t count = journal.trials().size();
  journal.add({{{"flat", "7"}}, {50.0}}, 1.5);
  const lab::TuningJournal again(path.parent_path(), purpose);
  require(again.trials().size() == journal.trials().size() && again.trials().size() >= count,
          "trials that are lost");
}

/// Describes a filter, completes it and applies it to every step of a run.
void read_filter(Bytes bytes) {
  static const auto run =
      debug::make_run(test::stair_subject(0.003), test::options_of(planes::Profile::refined));
  const std::string text = text_of(bytes);
  for (const std::size_t cursor : {text.size(), text.size() / 2, std::size_t{0}})
    for (const debug::Completion& completion : debug::complete_filter(text, cursor))
      require(completion.begin <= completion.end && completion.end <= text.size(),
              "a completion outside of the text");
  debug::FilterProblem problem;
  const auto filter = debug::Filter::parse(text, problem);
  require(filter || (problem.begin <= problem.end && problem.end <= text.size() &&
                     !problem.message.empty()),
          "a problem outside of the text");
  if (filter) filter->matching(*run);
}

/// The first lines; more would only be slower.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines = split(text, '\n');
  lines.resize(std::min<std::size_t>(lines.size(), 32));
  return lines;
}

/// Lines NAME=VALUE, as accepted by --set.
planes::PipelineOptions options_from(const std::string& text) {
  planes::PipelineOptions options;
  for (const std::string& line : lines_of(text)) {
    const std::size_t equals = std::min(line.find('='), line.size());
    const std::string name = line.substr(0, equals);
    try {
      planes::set_option(options, name, line.substr(std::min(equals + 1, line.size())));
    } catch (const Error& error) {
      require(error.what()[0] != '\0', "an Error without a message");
      continue;
    }
    // An option accepts the value that it reports.
    const planes::OptionInfo& info = planes::find_option(name);
    const std::string value = info.get(options);
    planes::set_option(options, name, value);
    require(info.get(options) == value, "option " + name + " changes: " + value);
    if (info.is_number()) info.set(options, planes::number_text(info, number_of(info, options)));
  }
  return options;
}

void read_options(Bytes bytes) {
  const std::string text = text_of(bytes);
  const planes::PipelineOptions options = options_from(text);
  for (const planes::OptionInfo& info : planes::option_table()) {
    planes::is_idle(info, options);
    info.matters(options);
  }
  for (const std::string& line : lines_of(text)) try {
      planes::parse_gravity(line);
    } catch (const Error&) {
      // Not a number.
    }
}

void read_report_target(Bytes bytes) { report::parse_report_target(text_of(bytes)); }

/// Finds planes in any frame that a reader may return.
void find_planes(const Frame& frame) {
  static const auto classifier = planes::make_pca_classifier();
  planes::PipelineOptions options;
  options.gravity.none_where_unknown = true;
  const planes::FrameResult result = planes::run_frame(frame, options, classifier.get());
  require(result.plane_of.size() == result.cloud.points.size(), "planes of other points");
}

void find_planes_in_cloud(Bytes bytes) {
  Frame frame;
  frame.depth_unit_m = 1;
  frame.cloud = io::read_cloud_file(file_of("planes_in_cloud/a.ply", bytes));
  find_planes(frame);
}

/// Width, unit, camera and gravity, followed by counts; numbers are limited as by settle_camera().
void find_planes_in_depth(Bytes bytes) {
  constexpr std::size_t kHead = 2 + 13 * sizeof(double);
  if (bytes.size() < kHead) return;
  io::ByteReader in(std::as_bytes(bytes));
  const auto byte = [&] { return in.read<std::uint8_t>(); };
  const auto real = [&] { return in.read<double>(); };
  Frame frame;
  const int width = 1 + byte() % 40;
  frame.depth_unit_m = real();
  Intrinsics& k = frame.intrinsics;
  for (double* value : {&k.fx, &k.fy, &k.cx, &k.cy}) *value = real();
  k.distortion = static_cast<Distortion>(byte() % 3);
  for (double& coefficient : k.coefficients) coefficient = real();
  const Vec3d gravity(real(), real(), real());
  const Bytes counts = bytes.subspan(kHead);
  const int height = static_cast<int>(counts.size() / 2) / width;
  bool finite = frame.depth_unit_m > 0 && std::isfinite(frame.depth_unit_m) && k.fx > 0 && k.fy > 0;
  for (const double value : {k.fx, k.fy, k.cx, k.cy}) finite = finite && std::isfinite(value);
  for (const double value : k.coefficients) finite = finite && std::isfinite(value);
  if (!finite || height < 1 || height > 64) return;
  k.width = width;
  k.height = height;
  frame.depth = Image16(width, height);
  for (std::size_t i = 0; i < frame.depth.data.size(); ++i)
    frame.depth.data[i] = static_cast<std::uint16_t>(counts[2 * i] | counts[2 * i + 1] << 8);
  if (gravity.allFinite() && gravity.norm() > 1e-9)
    frame.gravity = Gravity{gravity.normalized(), GravitySource::sidecar, 1, "given"};
  find_planes(frame);
}

}  // namespace

std::vector<Target> document_targets() {
  return {{"json", read_json},
          {"weights", read_weights},
          {"report", read_report},
          {"frame_record", read_frame_record},
          {"rules", read_rules},
          {"profile", read_profile},
          {"tuning_journal", read_tuning_journal},
          {"filter", read_filter},
          {"options", read_options},
          {"report_target", read_report_target},
          {"planes_in_cloud", find_planes_in_cloud},
          {"planes_in_depth", find_planes_in_depth}};
}

}  // namespace planescope::fuzz
