// Tests of the event filter: syntax, completion and matched steps.

#include "core/debug/filter/filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <sstream>

#include "replay_subject.hpp"
#include "support/scenes.hpp"

namespace planescope::debug {
namespace {

FilterProblem problem_of(const std::string& text) {
  FilterProblem problem;
  EXPECT_FALSE(Filter::parse(text, problem).has_value()) << text;
  EXPECT_FALSE(problem.message.empty()) << text;
  return problem;
}

/// The part of the text that the error marks.
std::string marked(const std::string& text) {
  const FilterProblem problem = problem_of(text);
  return text.substr(problem.begin, problem.end - problem.begin);
}

TEST(FilterText, ExamplesOfTheManualAreAccepted) {
  for (const char* text : {"",
                           "  ",
                           "visit",
                           "case==III && depth>=5 && mse>0.8*theta_mse",
                           "merge && offset>0.02",
                           "plane==7",
                           "P7==plane",
                           "plane!=P12",
                           "point==1234",
                           "truth.mixed",
                           "!(visit||decide)",
                           "!depth>5",
                           "-offset < -1.5e-2",
                           "(depth+1)*2 - 3/4 >= .5",
                           "label==h && stage==grow",
                           "stage!=parts",
                           "N_out>θ_Nout",
                           "mse<=theta_e_n",
                           "((case==I))",
                           "2<depth"}) {
    FilterProblem problem;
    EXPECT_TRUE(Filter::parse(text, problem).has_value()) << text << ": " << problem.message;
  }
}

TEST(FilterText, ErrorsMarkTheWrongWord) {
  EXPECT_EQ(marked("depth>3 && dpeth<5"), "dpeth");
  EXPECT_EQ(marked("depth>"), ">");
  EXPECT_EQ(marked("(depth>3"), "(");
  EXPECT_EQ(marked("depth>3)"), ")");
  EXPECT_EQ(marked("depth=3"), "=");
  EXPECT_EQ(marked("depth>3 visit"), "visit");
  EXPECT_EQ(marked("1<depth<5"), "<");
  EXPECT_EQ(marked("offset>2cm"), "2cm");
  EXPECT_EQ(marked("depth > 1e999"), "1e999");
  EXPECT_EQ(marked("depth>3 && #"), "#");
}

TEST(FilterText, TypesAreChecked) {
  EXPECT_EQ(marked("case==3"), "3");
  EXPECT_EQ(marked("case>III"), ">");
  EXPECT_EQ(marked("label==III"), "III");
  EXPECT_EQ(marked("depth"), "depth");
  EXPECT_EQ(marked("visit+1>2"), "visit");
  EXPECT_EQ(marked("visit==merge"), "==");
  EXPECT_EQ(marked("plane>7"), ">");
  EXPECT_EQ(marked("plane==depth"), "depth");
  EXPECT_EQ(marked("point==P3"), "P3");
  EXPECT_EQ(marked("depth==P3"), "P3");
  EXPECT_EQ(marked("!depth"), "depth");
  EXPECT_NE(problem_of("case>3").message.find("a number"), std::string::npos);
}

TEST(FilterText, TheNearestNameIsProposed) {
  EXPECT_NE(problem_of("dpeth>3").message.find("did you mean 'depth'"), std::string::npos);
  EXPECT_NE(problem_of("visit and depth>3").message.find("'&&'"), std::string::npos);
  EXPECT_NE(problem_of("depth=3").message.find("'=='"), std::string::npos);
}

TEST(FilterText, ExcessiveNestingIsRejected) {
  problem_of(std::string(5000, '(') + "visit" + std::string(5000, ')'));
  problem_of(std::string(5000, '!') + "visit");
  problem_of("depth>" + std::string(5000, '-') + "1");
}

void expect_place_inside(const std::string& text) {
  FilterProblem problem;
  if (Filter::parse(text, problem)) return;
  EXPECT_LE(problem.begin, problem.end) << text;
  EXPECT_LE(problem.end, text.size()) << text;
  EXPECT_FALSE(problem.message.empty()) << text;
}

TEST(FilterText, RandomBytesAreRejectedWithAPositionInTheText) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (int n = random.integer(0, 24); n > 0; --n)
      text += static_cast<char>(random.integer(0, 255));
    expect_place_inside(text);
    complete_filter(text, static_cast<std::size_t>(random.integer(0, 30)));
  }
}

TEST(FilterText, RandomWordsAreAcceptedOrRejectedWithAPositionInTheText) {
  std::vector<std::string> words = {"(",   ")",   "!",  "&&", "||", "==", "!=", "<",
                                    "<=",  ">",   ">=", "+",  "-",  "*",  "/",  "7",
                                    "0.5", "1e3", "P3", "=",  "&",  ".",  "x1", "("};
  for (const FilterName& name : filter_names()) words.push_back(name.name);
  Random random(2);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (int n = random.integer(1, 8); n > 0; --n)
      text += words[random.integer(0, static_cast<int>(words.size()) - 1)] +
              (random.integer(0, 1) ? " " : "");
    expect_place_inside(text);
    FilterProblem problem;
    accepted += Filter::parse(text, problem).has_value();
    for (std::size_t cursor = 0; cursor <= text.size(); cursor += 3)
      for (const Completion& completion : complete_filter(text, cursor)) {
        ASSERT_LE(completion.begin, cursor);
        ASSERT_LE(completion.end, text.size());
      }
  }
  EXPECT_GT(accepted, 100);
}

TEST(FilterManual, ContainsEveryNameAndTheMethodsOptions) {
  std::stringstream manual;
  for (const char* page : {"filter.md", "method.md"})
    manual << std::ifstream(std::string(PLANESCOPE_SOURCE_DIR "/docs/") + page).rdbuf();
  for (const FilterName& name : filter_names())
    EXPECT_NE(manual.str().find("`" + name.name + "`"), std::string::npos) << name.name;
}

std::vector<std::string> at_end(const std::string& text) {
  std::vector<std::string> inserts;
  for (const Completion& completion : complete_filter(text, text.size()))
    inserts.push_back(completion.insert);
  return inserts;
}

bool offers(const std::vector<std::string>& completions, const std::string& name) {
  return std::find(completions.begin(), completions.end(), name) != completions.end();
}

TEST(FilterCompletion, OffersNamesThatStartWithTheLettersFirst) {
  const auto completions = at_end("de");
  ASSERT_GE(completions.size(), 3u);
  EXPECT_EQ(completions[0], "decide");
  EXPECT_EQ(completions[1], "depth");
  EXPECT_TRUE(offers(completions, "node"));
}

TEST(FilterCompletion, OffersTheValuesOfTheComparedField) {
  EXPECT_EQ(at_end("case=="), (std::vector<std::string>{"I", "II", "III", "IV"}));
  EXPECT_EQ(at_end("visit && label != "), (std::vector<std::string>{"h", "v"}));
  EXPECT_EQ(at_end("case==II"), (std::vector<std::string>{"II", "III"}));
}

TEST(FilterCompletion, OffersThresholdsFirstForNumbers) {
  const auto completions = at_end("mse>0.8*");
  ASSERT_FALSE(completions.empty());
  EXPECT_TRUE(completions[0].starts_with("theta_"));
  EXPECT_FALSE(offers(completions, "visit"));
}

TEST(FilterCompletion, OffersOperatorsAfterAValue) {
  EXPECT_TRUE(offers(at_end("depth "), ">="));
  EXPECT_EQ(at_end("case "), (std::vector<std::string>{"==", "!="}));
  EXPECT_EQ(at_end("depth>3 "), (std::vector<std::string>{"&&", "||"}));
  EXPECT_EQ(at_end("visit "), (std::vector<std::string>{"&&", "||"}));
}

TEST(FilterCompletion, OffersNothingWhileANumberIsTyped) { EXPECT_TRUE(at_end("depth>3").empty()); }

TEST(FilterCompletion, ReplacesTheWholeWordAtTheCursor) {
  const auto completions = complete_filter("visit && dexx>3", 11);
  ASSERT_FALSE(completions.empty());
  EXPECT_EQ(completions[0].begin, 9u);
  EXPECT_EQ(completions[0].end, 13u);
}

std::shared_ptr<const Run> run_of(planes::Profile profile, double noise_m = 0.003) {
  return make_run(test::stair_subject(noise_m), test::options_of(profile));
}

std::vector<std::int32_t> steps_of(const Run& run, const std::string& text) {
  FilterProblem problem;
  const auto filter = Filter::parse(text, problem);
  EXPECT_TRUE(filter.has_value()) << text << ": " << problem.message;
  if (!filter) return {};
  const std::vector<std::int32_t> steps = filter->matching(run);
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    EXPECT_EQ(filter->matches(run, step), std::binary_search(steps.begin(), steps.end(), step));
  return steps;
}

/// Steps whose event satisfies the condition.
std::vector<std::int32_t> steps_where(const Run& run,
                                      const std::function<bool(const planes::TraceEvent&)>& has) {
  std::vector<std::int32_t> steps;
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    if (has(*run.event_at(step))) steps.push_back(step);
  return steps;
}

TEST(Filter, AnEmptyTextMatchesEveryEvent) {
  const auto run = run_of(planes::Profile::paper);
  EXPECT_EQ(steps_of(*run, " ").size(), run->trace.events.size());
}

TEST(Filter, KindsOfEventsPartitionTheTrace) {
  const auto run = run_of(planes::Profile::refined);
  std::size_t sum = 0;
  for (const char* kind :
       {"visit", "decide", "found", "merge", "assign", "drop", "refine && !merge"})
    sum += steps_of(*run, kind).size();
  EXPECT_EQ(sum, run->trace.events.size());
}

TEST(Filter, FindsCasesByDepthAndError) {
  const auto run = run_of(planes::Profile::paper);
  const auto expected = steps_where(*run, [&](const planes::TraceEvent& e) {
    return e.type == planes::EventType::decide && e.node_case == 4 &&
           run->octree().nodes[e.node].depth >= 4 &&
           run->facts[e.node].fit.eigenvalues[0] > 0.1 * 0.005;
  });
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(steps_of(*run, "case==IV && depth>=4 && mse>0.1*theta_mse"), expected);
  EXPECT_EQ(steps_of(*run, "!(case!=IV || 4>depth || mse<=theta_e_n_m2/10) && decide && case==IV"),
            expected);
}

TEST(Filter, TheErrorIsKnownOnlyIfCriterion3WasTested) {
  const auto run = run_of(planes::Profile::paper);
  EXPECT_TRUE(steps_of(*run, "mse>=0 && (case==I || case==II)").empty());
  EXPECT_EQ(steps_of(*run, "mse>=0"), steps_of(*run, "case==III || case==IV"));
}

TEST(Filter, AnEventWithoutTheFieldMakesEveryComparisonFalse) {
  const auto run = run_of(planes::Profile::paper);
  EXPECT_EQ(steps_of(*run, "offset==0 || offset!=0"), steps_of(*run, "merge"));
  EXPECT_TRUE(steps_of(*run, "visit && n_out>=0").empty());
}

TEST(Filter, APlaneIsFoundInBothFields) {
  const auto run = run_of(planes::Profile::refined);
  const std::int32_t first = run->timeline.plane_of_number(1);
  const auto expected = steps_where(
      *run, [&](const planes::TraceEvent& e) { return e.plane == first || e.other == first; });
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(steps_of(*run, "plane==1"), expected);
  EXPECT_EQ(steps_of(*run, "P1==plane"), expected);
  const auto others = steps_where(*run, [&](const planes::TraceEvent& e) {
    return e.plane >= 0 && e.plane != first && e.other != first;
  });
  EXPECT_EQ(steps_of(*run, "plane!=P1"), others);
}

TEST(Filter, APointIsFoundInItsNodesAndInChangesOfItsPlane) {
  const auto run = run_of(planes::Profile::refined);
  for (const std::int32_t point : {0, 500, 1500}) {
    const auto steps = steps_of(*run, "point==" + std::to_string(point));
    for (const planes::PointChange& change : run->timeline.changes_of_point(point))
      EXPECT_TRUE(std::binary_search(steps.begin(), steps.end(), change.step));
    for (const std::int32_t node : run->timeline.path_of_point(point))
      EXPECT_TRUE(std::binary_search(steps.begin(), steps.end(), run->timeline.visited_at()[node]));
    EXPECT_LT(steps.size(), run->trace.events.size());
  }
  EXPECT_TRUE(steps_of(*run, "point==1e9").empty());
  EXPECT_TRUE(steps_of(*run, "point==0.5").empty());
}

TEST(Filter, ThresholdsAreThoseOfTheRun) {
  auto subject = test::stair_subject(0.003);
  planes::PipelineOptions options = test::options_of(planes::Profile::paper);
  options.segment.theta_n_in = 17;
  const auto run = make_run(subject, options);
  EXPECT_EQ(steps_of(*run, "decide && n_in<theta_n_in && n_out==0"),
            steps_of(*run, "decide && n_in<17 && n_out==0"));
}

TEST(Filter, TruthFindsTheMergeThatFusesTwoSteps) {
  // The paper's Criterion 4 compares only directions.
  auto subject = test::stair_subject(0.003);
  planes::PipelineOptions options = test::options_of(planes::Profile::paper);
  options.segment.theta_coplane = 0.5;
  const auto run = make_run(subject, options);
  const auto steps = steps_of(*run, "merge && truth.wrong");
  ASSERT_FALSE(steps.empty());
  const planes::TraceEvent& first = *run->event_at(steps.front());
  EXPECT_GT(first.value, 0.02f) << describe_event(*run, steps.front());
  const auto founded = steps_of(*run, "found && plane==" + plane_name(*run, first.plane));
  ASSERT_EQ(founded.size(), 1u);
  const std::int32_t founder = run->event_at(founded[0])->node;
  EXPECT_NE(run->facts[first.node].truth_plane, run->facts[founder].truth_plane);
  EXPECT_TRUE(steps_of(*run_of(planes::Profile::refined, 0), "merge && truth.wrong").empty());
}

TEST(Filter, WithoutTruthNothingIsWrong) {
  auto subject = test::stair_subject(0.003);
  subject->voxel_truth = {};
  const auto run = make_run(subject, test::options_of(planes::Profile::paper));
  EXPECT_TRUE(steps_of(*run, "truth.wrong || truth.mixed || truth.plane>=0").empty());
}

TEST(Filter, ThePositionIsInTheWorld) {
  const auto run = run_of(planes::Profile::paper);
  const auto expected = steps_where(*run, [&](const planes::TraceEvent& e) {
    if (e.type != planes::EventType::assign && e.type != planes::EventType::drop) return false;
    return run->subject->prepared.voxels.points[e.point].z() > 0.2f;
  });
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(steps_of(*run, "(assign || drop) && z>0.2"), expected);
}

}  // namespace
}  // namespace planescope::debug
