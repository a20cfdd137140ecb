#include "core/planes/pipeline/classifiers.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::planes {
namespace {

PipelineOptions with_classifier(const std::string& name) {
  PipelineOptions options;
  set_option(options, "classifier", name);
  return options;
}

std::string error_of(const std::string& name, const std::filesystem::path& shipped) {
  try {
    make_classifier(with_classifier(name), shipped);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Classifiers, AreMadeByName) {
  EXPECT_EQ(make_classifier(with_classifier("pca"), {}).classifier->name(), "pca");
  EXPECT_EQ(make_classifier(with_classifier("truth"), {}).classifier, nullptr);
  EXPECT_FALSE(make_classifier(with_classifier("pca"), {}).weights);
}

TEST(Classifiers, WithoutTheirWeightsAreAnErrorThatNamesTheFile) {
  EXPECT_EQ(error_of("gcn", "nowhere/shipped.safetensors"),
            "nowhere/shipped.safetensors: no such file");
  EXPECT_EQ(error_of("nowhere/own.safetensors", "nowhere/shipped.safetensors"),
            "nowhere/own.safetensors: no such file");
}

TEST(Classifiers, TakeAnythingThatLooksLikeAPathForAFile) {
  for (const char* name : {"own.safetensors", "./own", "dir/own", "/own", "."})
    EXPECT_TRUE(names_weights_file(name)) << name;
  for (const char* name : {"gcm", "", "ground-truth"})
    EXPECT_FALSE(names_weights_file(name)) << name;
}

}  // namespace
}  // namespace planescope::planes
