// Tests of planes' certainty against exact truth.

#include "core/lab/experiments/measure_outlines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/lab/experiments/cells.hpp"

namespace planescope::lab {
namespace {

// The sigma is neither too small nor uselessly large: half of all errors are within 0.67 sigma.
TEST(Certainty, TruePlanesAreWithinTwoSigmaInNineteenOfTwentyCases) {
  const planes::PipelineOptions options;
  const planes::ChosenClassifier chosen = planes::make_classifier(
      options, std::filesystem::path(PLANESCOPE_SOURCE_DIR) / "assets" / "classifier.safetensors");
  std::vector<double> errors;  // [sigma]
  for (const std::string& set : depth_sets())
    for (int i = 0; i < 5; ++i) {
      const EvaluationFrame frame = make_evaluation_frame(find_evaluation_set(set), i,
                                                          {.seed = 7, .errors = DepthErrors::d435});
      for (const OutlineScore& plane :
           score_outlines(frame, options, chosen.classifier.get()).planes)
        if (plane.iou >= 0.5 && plane.true_m2 >= 0.02)
          for (const double error : plane.off_sigmas) errors.push_back(std::abs(error));
    }
  ASSERT_GE(errors.size(), 150u);
  std::ranges::sort(errors);
  const auto within = std::ranges::upper_bound(errors, 2.0) - errors.begin();
  EXPECT_GE(within, 0.93 * static_cast<double>(errors.size()));
  EXPECT_GE(errors[errors.size() / 2], 0.25);
  EXPECT_LE(errors[errors.size() / 2], 0.9);
}

}  // namespace
}  // namespace planescope::lab
