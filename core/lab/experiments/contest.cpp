#include "core/lab/experiments/contest.hpp"

#include "core/lab/experiments/paper_plan.hpp"

namespace planescope::lab {

planes::SourceTruth truth_of(const EvaluationFrame& frame) {
  planes::SourceTruth truth = frame.labels ? planes::truth_of_labels(*frame.labels)
                                           : *planes::truth_of_cloud(*frame.frame.cloud);
  if (!frame.normals.empty()) truth.normals = frame.normals;  // exact ones, where they are known
  return truth;
}

Contest::Contest(const Frame& frame,
                 const Labellers& labellers,
                 const planes::SourceTruth* truth,
                 std::optional<double> max_range_m)
    : frame_(frame), labellers_(labellers), max_range_m_(max_range_m) {
  if (truth) on_points_ = planes::truth_on_points(truth->values, planes::measured_sources(frame));
}

planes::FrameResult Contest::run(const CellKey& key) {
  const planes::PipelineOptions options = this->options(key);
  if (options.method != planes::Method::ours) return planes::run_frame(frame_, options, nullptr);
  planes::FrameResult result{prepared(key.classifier, key), {}, {}};
  planes::FoundRegions found = planes::find_regions(frame_, result, options);
  result.segmentation = std::move(found.segmentation);
  result.plane_of = std::move(found.plane_of);
  return result;
}

const planes::PreparedFrame& Contest::prepared(const std::string& labels, const CellKey& key) {
  const planes::PipelineOptions of_labels = options(with_ours(key, key.profile, labels));
  const auto [at, is_new] =
      prepared_.try_emplace({labels, planes::is_found_on_pixels(frame_, of_labels)});
  if (!is_new) return at->second;
  const planes::Classifier* classifier =  // without labels: any will do, they are not used
      labels == "gcn"   ? labellers_.gcn.get()
      : labels == "pca" ? labellers_.pca.get()
                        : nullptr;
  at->second = planes::prepare_frame(frame_, of_labels, classifier, &on_points_);
  return at->second;
}

planes::PipelineOptions Contest::options(const CellKey& key) const {
  planes::PipelineOptions options = cell_options(key);
  if (max_range_m_) options.cloud.max_range_m = *max_range_m_;
  return options;
}

}  // namespace planescope::lab
