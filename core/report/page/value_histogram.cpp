#include "core/report/page/value_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "core/planes/segment/criteria.hpp"

namespace planescope::report {
namespace {

constexpr int kBins = 40;
constexpr double kRoom = 4;  // bins end at this many thresholds: that is where decisions are near

class Counter {
 public:
  Counter(std::string name, double high, double threshold) {
    histogram_.name = std::move(name);
    histogram_.high = high;
    histogram_.threshold = threshold;
    histogram_.counts.resize(kBins + 2);
  }
  void add(double value) {
    const double bin = std::ceil(value * kBins / histogram_.high - 1e-9);
    ++histogram_.counts[static_cast<std::size_t>(bin <= 0 ? 0 : bin <= kBins ? bin : kBins + 1)];
  }
  ValueHistogram histogram() && { return std::move(histogram_); }

 private:
  ValueHistogram histogram_;
};

ValueHistogram outliers(const planes::Octree& octree, const planes::SegmentOptions& options) {
  // Bins as wide as whole numbers.
  const double width = std::max(1.0, std::ceil(kRoom * options.theta_n_out / kBins));
  Counter counter("n_out", kBins * width, options.theta_n_out);
  for (const planes::OctreeNode& node : octree.nodes)
    if (node.decided != planes::Case::none)
      counter.add(planes::purity_of(node, options.use_labels).n_out);
  return std::move(counter).histogram();
}

ValueHistogram over_limits(const char* name, std::span<const float> values) {
  Counter counter(name, kRoom, 1);
  for (const float value : values) counter.add(value);
  return std::move(counter).histogram();
}

}  // namespace

double ValueHistogram::edge(std::size_t bin) const {
  return high * static_cast<double>(bin) / static_cast<double>(counts.size() - 2);
}

std::uint64_t ValueHistogram::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::vector<ValueHistogram> decision_histograms(const planes::Segmentation& segmentation,
                                                const planes::Strains& strains,
                                                const planes::SegmentOptions& options) {
  if (segmentation.octree.nodes.empty()) return {};
  return {outliers(segmentation.octree, options), over_limits("planarity", strains.planarity),
          over_limits("merge_angle", strains.angle),
          over_limits("merge_distance", strains.distance)};
}

void add_to(ValueHistogram& sum, const ValueHistogram& part) {
  if (sum.name != part.name || sum.high != part.high || sum.counts.size() != part.counts.size())
    return;
  for (std::size_t bin = 0; bin < part.counts.size(); ++bin) sum.counts[bin] += part.counts[bin];
}

std::string title_of(const ValueHistogram& histogram) {
  if (histogram.name == "n_out") return "Outliers N_out of each node visited";
  if (histogram.name == "planarity") return "Criterion 3: deviation from a plane, over its limit";
  if (histogram.name == "merge_angle") return "Merging: angle to the nearest plane, over its limit";
  if (histogram.name == "merge_distance")
    return "Merging: distance of the nearest plane, over its limit";
  return histogram.name;
}

}  // namespace planescope::report
