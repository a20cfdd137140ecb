// Tests of reading and writing profile files.

#include <gtest/gtest.h>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::planes {
namespace {

namespace fs = std::filesystem;

fs::path written(const std::string& text) {
  const fs::path path =
      fs::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".json");
  write_file_text(path, text);
  return path;
}

std::string with_options(const std::string& options) {
  return R"({"schema": "planescope.profile/1", "base": "refined", "options": {)" + options + "}}";
}

/// Error message of reading a file, without the file's name in front.
std::string refusal_of(const std::string& text) {
  const fs::path path = written(text);
  try {
    (void)read_profile(path);
  } catch (const Error& error) {
    const std::string what = error.what(), file = path.string() + ": ";
    EXPECT_TRUE(what.starts_with(file)) << what;
    return what.substr(std::min(what.size(), file.size()));
  }
  ADD_FAILURE() << "was taken: " << text;
  return {};
}

TEST(ProfileFile, AFolderOfTheSameNameDoesNotHideAProfile) {
  const fs::path before = fs::current_path(), dir = fs::path(testing::TempDir()) / "hides";
  fs::create_directories(dir / "paper");
  fs::current_path(dir);
  PipelineOptions options;
  set_profile(options, "paper");
  fs::current_path(before);
  fs::remove_all(dir);
  EXPECT_EQ(options.segment.profile, Profile::paper);
}

TEST(ProfileFile, EveryOptionIsReadBackAsWritten) {
  for (const Profile base : {Profile::paper, Profile::paper_closest, Profile::refined}) {
    PipelineOptions wanted;
    wanted.segment = profile_options(base);
    set_option(wanted, "theta_coplane", "0.8765432109876543");
    set_option(wanted, "worth_px", "123");
    set_option(wanted, "gravity", "0,1,0");
    ProfileFile all{base, {}};
    for (const OptionInfo& info : option_table())
      if (info.name != "profile") all.options.emplace_back(info.name, info.get(wanted));
    const fs::path path = written(profile_text(all));

    PipelineOptions made;
    set_profile(made, path.string());
    for (const OptionInfo& info : option_table())
      EXPECT_EQ(info.get(made), info.get(wanted)) << info.name;
    EXPECT_EQ(read_profile(path).options, all.options);
  }
}

TEST(ProfileFile, StartsFromItsBaseAndKeepsOtherStages) {
  PipelineOptions options;
  set_option(options, "theta_n_out", "77");
  set_option(options, "max_range_m", "4");
  set_profile(
      options,
      written(
          R"({"schema": "planescope.profile/1", "base": "paper", "options": {"theta_n_in": 9}})")
          .string());
  EXPECT_EQ(options.segment.profile, Profile::paper);
  EXPECT_EQ(options.segment.theta_n_in, 9);
  EXPECT_EQ(options.segment.theta_n_out, profile_options(Profile::paper).theta_n_out);
  EXPECT_EQ(options.cloud.max_range_m, 4);
}

TEST(ProfileFile, BuiltInNamesAreNotFiles) {
  PipelineOptions options;
  set_profile(options, "paper-closest");
  EXPECT_EQ(options.segment.profile, Profile::paper_closest);
  EXPECT_THROW(set_profile(options, "refned"), Error);
  EXPECT_THROW(set_profile(options, "no/such/file.json"), Error);
}

TEST(ProfileFile, ErrorsAreReportedInOneLine) {
  EXPECT_EQ(refusal_of("[]"), "the file is []; expected an object");
  EXPECT_EQ(refusal_of("{}"), "the file has no \"schema\"; expected planescope.profile/1");
  EXPECT_EQ(refusal_of(R"({"schema": "planescope.session/1"})"),
            "schema is \"planescope.session/1\"; expected planescope.profile/1");
  EXPECT_EQ(refusal_of(R"({"schema": "planescope.profile/1", "base": "fine"})"),
            "unknown profile 'fine'; expected paper, paper-closest, or refined");
  EXPECT_EQ(refusal_of(R"({"schema": "planescope.profile/1", "base": 3})"),
            "base is 3; expected text");
  EXPECT_EQ(refusal_of(R"({"schema": "planescope.profile/1", "option": {}})"),
            "the file has an unknown key, \"option\"; expected one of schema, base, options");
  EXPECT_EQ(refusal_of(R"({"schema": "planescope.profile/1", "options": []})"),
            "options is []; expected an object");
  EXPECT_EQ(refusal_of(with_options(R"("theta_coplan": 0.9)")),
            "unknown option 'theta_coplan'; did you mean 'theta_coplane'?");
  EXPECT_EQ(refusal_of(with_options(R"("theta_coplane": "0.9")")),
            "option theta_coplane is \"0.9\"; expected a number");
  EXPECT_EQ(refusal_of(with_options(R"("theta_coplane": 1.5)")),
            "option theta_coplane: 1.5 is out of range; expected at least 0 and at most 1");
  EXPECT_EQ(refusal_of(with_options(R"("theta_n_in": 9.5)")),
            "option theta_n_in: '9.5' is not a whole number");
  EXPECT_EQ(refusal_of(with_options(R"("criterion4_n2": 1)")),
            "option criterion4_n2 is 1; expected true or false");
  EXPECT_EQ(refusal_of(with_options(R"("merge_partner": "worst")")),
            "option merge_partner: unknown value 'worst'; expected first or best");
  EXPECT_EQ(refusal_of(with_options(R"("profile": "paper")")),
            "option profile: not allowed in a profile file; use \"base\" instead");
  EXPECT_NE(refusal_of("{\"schema\": ").find("not valid JSON"), std::string::npos);
}

}  // namespace
}  // namespace planescope::planes
