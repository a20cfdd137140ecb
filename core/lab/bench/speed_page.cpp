// index.html of `planescope-lab bench speed`, from assets/report/results_page.mustache.

#include "core/lab/bench/speed_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lab/bench/results_page.hpp"
#include "core/report/page/charts.hpp"

namespace planescope::lab {
namespace {

using kainjow::mustache::html_escape;

std::vector<std::pair<std::string, std::string>> speed_facts(const ChainSpeed& speed) {
  std::vector<std::pair<std::string, std::string>> facts;
  const auto add = [&](const std::string& name, const std::string& html) {
    facts.emplace_back(name, html);
  };
  add("Command", "<pre>" + html_escape(speed.command) + "</pre>");
  add("planescope",
      fmt::format("{}, commit <code>{}</code>{}", html_escape(speed.build.version),
                  html_escape(speed.build.commit), speed.build.modified ? " with changes" : ""));
  add("Weights of gcn",
      fmt::format("{} ({})", html_escape(speed.weights.file), html_escape(speed.weights.network)));
  for (const SubjectFacts& subject : speed.subjects)
    add("Measured on", fmt::format("{}, {} {}", html_escape(subject.name), subject.frames,
                                   subject.width > 0 ? fmt::format("frames of {} x {}",
                                                                   subject.width, subject.height)
                                                     : "clouds"));
  add("Machine", html_escape(to_text(speed.machine)));
  if (speed.peaks.bytes_per_s > 0)
    add("One core", fmt::format("copies {:.1f} GB/s; {:.0f} GFLOP/s of multiplications and "
                                "additions in single precision",
                                speed.peaks.bytes_per_s * 1e-9, speed.peaks.flops_per_s * 1e-9));
  add("Rounds", fmt::format("{}, a first one not counted; in each, everything that is compared "
                            "takes its turn",
                            speed.rounds));
  add("Elsewhere",
      "The segmentation against a plain one on an octree of pointers: <code>scripts/bench "
      "'ours|plain'</code>. The network against itself written plainly: <code>planescope-lab bench "
      "classifier</code>. The window: <code>planescope-lab bench desktop</code>. Rivals of PCL and "
      "CGAL are here where the program was built with them.");
  return facts;
}

std::string speed_lead(const ChainSpeed& speed) {
  for (const MethodRow& row : speed.methods)
    if (row.method == "ours, refined, gcn")
      return fmt::format(
          "A frame takes {:.1f} ms from depth to the planes of its pixels on one thread, {:.2f} "
          "times as long as CAPE-style region growing ({}, profile refined, classifier gcn).",
          row.ms.median, row.ratio, row.recording);
  return "How long each step from depth to planes takes, and how that grows.";
}

constexpr double kMostShown = 6;  // of region growing's time: more would flatten all others

/// One group of bars for each recording.
Plot method_plot(const ChainSpeed& speed) {
  report::BarChart chart{
      .title = "Time of a frame as a multiple of region growing's", .groups = {}, .bars = {}};
  double slowest = 0;
  for (const MethodRow& row : speed.methods) {
    if (std::ranges::find(chart.groups, row.recording) == chart.groups.end())
      chart.groups.push_back(row.recording);
    if (std::ranges::find(chart.bars, row.method, &report::Curve::name) == chart.bars.end())
      chart.bars.push_back({row.method, {}});
    if (std::isfinite(row.ratio)) slowest = std::max(slowest, row.ratio);
  }
  chart.high = std::min(slowest, kMostShown);
  for (report::Curve& bar : chart.bars)
    for (const std::string& group : chart.groups) {
      const auto row = std::ranges::find_if(speed.methods, [&](const MethodRow& each) {
        return each.method == bar.name && each.recording == group;
      });
      bar.values.push_back(row == speed.methods.end() ? std::numeric_limits<double>::quiet_NaN()
                                                      : row->ratio);
    }
  return {"A frame's time, region growing being 1",
          slowest > kMostShown
              ? fmt::format("Lower is quicker. Bars are cut off at {:.0f}.", kMostShown)
              : "Lower is quicker.",
          report::bar_chart(chart)};
}

Plot scaling_plot(const Scaling& scaling) {
  report::LineChart chart{.title = scaling.title + ": milliseconds",
                          .x_name = scaling.x_name,
                          .x = scaling.x,
                          .curves = {},
                          .log_x = true};
  double least = std::numeric_limits<double>::infinity();
  for (const ScalingCurve& curve : scaling.curves) {
    chart.curves.push_back({curve.name, curve.ms});
    for (const double ms : curve.ms)
      if (ms > 0) least = std::min(least, ms);
  }
  chart.log_from = std::isfinite(least) ? std::pow(10, std::floor(std::log10(least))) : 1;
  return {scaling.title + " [ms]", "Both axes are logarithmic.", report::line_chart(chart)};
}

std::vector<Chapter> speed_chapters(const ChainSpeed& speed) {
  std::vector<Chapter> chapters;
  if (!speed.stages.empty())
    chapters.push_back({"stages", "Stages", "", {}, {stage_table(speed), duel_table(speed)}});
  if (!speed.methods.empty())
    chapters.push_back({"frames", "Whole frames", "", {method_plot(speed)}, {method_table(speed)}});
  if (!speed.scaling.empty()) {
    Chapter chapter{"scaling",
                    "How times grow",
                    "With x as x to the power of the exponent, fitted by least squares of "
                    "logarithms: 1 is in proportion, 0 not at all, -1 halves where x doubles.",
                    {},
                    {}};
    for (const Scaling& scaling : speed.scaling) {
      chapter.plots.push_back(scaling_plot(scaling));
      chapter.tables.push_back(scaling_table(scaling));
    }
    chapters.push_back(std::move(chapter));
  }
  if (!speed.stage_memory.empty())
    chapters.push_back({"memory", "Memory", "", {}, memory_tables(speed)});
  if (!speed.commands.empty())
    chapters.push_back({"start", "Whole commands", "", {}, {command_table(speed)}});
  return chapters;
}

}  // namespace

std::vector<Table> speed_tables(const ChainSpeed& speed) {
  std::vector<Table> tables;
  for (const Chapter& chapter : speed_chapters(speed))
    tables.insert(tables.end(), chapter.tables.begin(), chapter.tables.end());
  return tables;
}

std::string speed_page(const ChainSpeed& speed) {
  const ResultsPage page{
      .title = "How fast planescope is",
      .brand = "planescope-lab bench speed",
      .lead = speed_lead(speed),
      .version = speed.build.version,
      .footer =
          "Times differ from machine to machine and from run to run; what counts are ratios "
          "of things that took turns. The same figures are in <code>speed.json</code>.",
      .facts = speed_facts(speed),
      .chapters = speed_chapters(speed)};
  return results_page(page);
}

}  // namespace planescope::lab
