// Tests of the option table, profiles and choice of classifier.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "support/refusal.hpp"

namespace planescope::planes {
namespace {

TEST(OptionsTable, EveryRowHasAUniqueNameAndADescription) {
  std::set<std::string> names;
  for (const OptionInfo& info : option_table()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.meaning.empty()) << info.name;
    EXPECT_FALSE(info.unit.empty()) << info.name;
    EXPECT_FALSE(info.section.empty()) << info.name;
  }
}

TEST(OptionsTable, SettingAllValuesOfAProfileGivesThatProfile) {
  for (const Profile profile : {Profile::paper, Profile::paper_closest, Profile::refined}) {
    PipelineOptions wanted;
    wanted.segment = profile_options(profile);
    // Start from another profile and set every row.
    PipelineOptions made;
    made.segment = profile_options(profile == Profile::paper ? Profile::refined : Profile::paper);
    for (const OptionInfo& info : option_table())
      if (info.name != "profile") info.set(made, info.get(wanted));
    for (const OptionInfo& info : option_table()) {
      if (info.name == "profile") continue;
      EXPECT_EQ(info.get(made), info.get(wanted)) << info.name;
    }
  }
}

TEST(OptionsTable, SettingTheProfileSetsAllItsDefaults) {
  PipelineOptions options;
  set_option(options, "theta_n_in", "99");
  set_option(options, "profile", "paper-closest");
  EXPECT_EQ(options.segment.theta_n_in, 10);
  EXPECT_FALSE(options.segment.criterion4_n2);
  set_option(options, "theta_n_in", "6");
  EXPECT_EQ(options.segment.theta_n_in, 6);
}

TEST(OptionsTable, ABadValueChangesNothing) {
  PipelineOptions options;
  for (const auto& [name, value] :
       std::vector<std::pair<std::string, std::string>>{{"theta_r_out", "1.5"},
                                                        {"theta_r_out", "-0.1"},
                                                        {"theta_n_in", "2"},
                                                        {"max_range_m", "0"},
                                                        {"voxel_size_m", "nan"},
                                                        {"pca_neighbours", "2"},
                                                        {"base_depth", "0"},
                                                        {"use_labels", "maybe"},
                                                        {"mse_normalization", "median"},
                                                        {"classifier", "gcm"},
                                                        {"gravity", "1,2"},
                                                        {"profile", "best"}}) {
    EXPECT_THROW(set_option(options, name, value), Error) << name << "=" << value;
  }
  const PipelineOptions untouched;
  for (const OptionInfo& info : option_table())
    EXPECT_EQ(info.get(options), info.get(untouched)) << info.name;
}

TEST(OptionsTable, EveryChoiceAndEveryEndOfARangeIsAccepted) {
  for (const OptionInfo& info : option_table()) {
    PipelineOptions options;
    for (const std::string& choice : info.choices) {
      info.set(options, choice);
      EXPECT_EQ(info.get(options), choice) << info.name;
    }
    EXPECT_EQ(info.choices.empty(), info.kind != OptionKind::choice) << info.name;
    if (!info.is_number()) continue;
    EXPECT_NO_THROW(info.set(options, number_text(info, -1e300))) << info.name;
    EXPECT_NO_THROW(info.set(options, number_text(info, 1e300))) << info.name;
  }
}

TEST(OptionsTable, ANumberIsReadBackAsSet) {
  PipelineOptions options;
  const OptionInfo& e_n = find_option("theta_e_n_m2");
  e_n.set(options, number_text(e_n, 0.1 / 3));
  EXPECT_EQ(number_of(e_n, options), 0.1 / 3);
  EXPECT_EQ(e_n.symbol, "θ_en");
  EXPECT_EQ(default_value(find_option("theta_n_in"), Profile::paper_closest), "10");
}

TEST(OptionsTable, AMistypedNameIsAnsweredWithTheNearest) {
  PipelineOptions options;
  try {
    set_option(options, "voxel_size", "0.01");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'voxel_size_m'"), std::string::npos) << error.what();
  }
}

TEST(OptionsTable, ARemovedNameIsAnsweredWithItsReplacement) {
  EXPECT_EQ(message_of([] { find_option("r1_max_angle_deg"); }),
            "option r1_max_angle_deg was removed in 0.2; see merge_cost");
  EXPECT_EQ(message_of([] { find_option("r6_refit"); }), "option r6_refit was removed in 0.2");
  EXPECT_NE(message_of([] { find_option("r99_knob"); }).find("unknown option"), std::string::npos)
      << "no earlier version had it";
}

TEST(OptionsTable, NoExistingOptionIsListedAsRemoved) {
  for (const RemovedOptions& removed : removed_options()) {
    for (const OptionInfo& info : option_table())
      EXPECT_EQ(std::ranges::count(removed.names, info.name), 0) << info.name;
    if (removed.by.empty()) continue;
    EXPECT_EQ(std::ranges::count(option_table(), removed.by, &OptionInfo::name), 1);
  }
}

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

TEST(Classifiers, AreCreatedByName) {
  EXPECT_EQ(make_classifier(with_classifier("pca"), {}).classifier->name(), "pca");
  EXPECT_EQ(make_classifier(with_classifier("truth"), {}).classifier, nullptr);
  EXPECT_FALSE(make_classifier(with_classifier("pca"), {}).weights);
}

TEST(Classifiers, WithoutWeightsAreAnErrorWithTheFileName) {
  EXPECT_EQ(error_of("gcn", "nowhere/shipped.safetensors"),
            "nowhere/shipped.safetensors: no such file");
  EXPECT_EQ(error_of("nowhere/own.safetensors", "nowhere/shipped.safetensors"),
            "nowhere/own.safetensors: no such file");
}

TEST(Classifiers, AreFilesIfTheirNameLooksLikeAPath) {
  for (const char* name : {"own.safetensors", "./own", "dir/own", "/own", "."})
    EXPECT_TRUE(names_weights_file(name)) << name;
  for (const char* name : {"gcm", "", "ground-truth"})
    EXPECT_FALSE(names_weights_file(name)) << name;
}

}  // namespace
}  // namespace planescope::planes
