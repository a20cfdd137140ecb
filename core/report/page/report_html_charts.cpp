// How near to their thresholds all decisions of the report fell.

#include <fmt/format.h>

#include <algorithm>

#include "core/report/page/line_chart.hpp"
#include "core/report/page/report_html_pieces.hpp"

namespace planescope::report::html {
namespace {

std::vector<ValueHistogram> summed(const Report& report) {
  std::vector<ValueHistogram> sums;
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames) {
      if (sums.empty()) {
        sums = frame.histograms;
        continue;
      }
      for (std::size_t k = 0; k < std::min(sums.size(), frame.histograms.size()); ++k)
        add_to(sums[k], frame.histograms[k]);
    }
  return sums;
}

std::uint64_t within_threshold(const ValueHistogram& histogram) {
  std::uint64_t count = 0;
  for (std::size_t bin = 0; bin + 1 < histogram.counts.size(); ++bin)
    if (histogram.edge(bin) <= histogram.threshold * (1 + 1e-9)) count += histogram.counts[bin];
  return count;
}

std::string cumulative_chart(const ValueHistogram& histogram) {
  LineChart chart;
  const bool counts = histogram.name == "n_out";
  chart.title =
      fmt::format("{}: share up to each value; {} are within the threshold", title_of(histogram),
                  share(within_threshold(histogram), histogram.total()));
  chart.x_name = counts ? "points" : "times the limit";
  chart.from_zero = true;
  chart.x_mark = histogram.threshold;
  chart.mark_name = counts ? fmt::format("threshold {:.6g}", histogram.threshold) : "limit";
  Curve curve{"%", {}, 0};
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin + 1 < histogram.counts.size(); ++bin) {
    sum += histogram.counts[bin];
    chart.x.push_back(histogram.edge(bin));
    curve.values.push_back(100 * static_cast<double>(sum) / static_cast<double>(histogram.total()));
  }
  chart.curves.push_back(std::move(curve));
  return line_chart(chart);
}

}  // namespace

void set_histograms(const PageSource& page, Data& data) {
  Data list{Data::type::list};
  for (const ValueHistogram& histogram : summed(page.report)) {
    if (histogram.total() == 0) continue;
    Data one;
    one.set("title", title_of(histogram));
    one.set("says", fmt::format("{} of {} within the threshold",
                                share(within_threshold(histogram), histogram.total()),
                                grouped(histogram.total())));
    one.set("svg", cumulative_chart(histogram));
    list.push_back(one);
  }
  data.set("has_histograms", list.is_non_empty_list());
  data.set("histograms", list);
}

}  // namespace planescope::report::html
