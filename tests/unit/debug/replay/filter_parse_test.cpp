#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/debug/filter/filter.hpp"
#include "support/scenes.hpp"

namespace planescope::debug {
namespace {

FilterProblem problem_of(const std::string& text) {
  FilterProblem problem;
  EXPECT_FALSE(Filter::parse(text, problem).has_value()) << text;
  EXPECT_FALSE(problem.message.empty()) << text;
  return problem;
}

/// The part of the text that the problem points at.
std::string marked(const std::string& text) {
  const FilterProblem problem = problem_of(text);
  return text.substr(problem.begin, problem.end - problem.begin);
}

TEST(FilterText, IsAcceptedAsTheManualShows) {
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
                           "label==h && refinement==R3",
                           "refinement!=split",
                           "N_out>θ_Nout",
                           "mse<=theta_e_n",
                           "((case==I))",
                           "2<depth"}) {
    FilterProblem problem;
    EXPECT_TRUE(Filter::parse(text, problem).has_value()) << text << ": " << problem.message;
  }
}

TEST(FilterText, ProblemsPointAtTheWordThatIsWrong) {
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

TEST(FilterText, ANameNearbyIsProposed) {
  EXPECT_NE(problem_of("dpeth>3").message.find("did you mean 'depth'"), std::string::npos);
  EXPECT_NE(problem_of("visit and depth>3").message.find("'&&'"), std::string::npos);
  EXPECT_NE(problem_of("depth=3").message.find("'=='"), std::string::npos);
}

TEST(FilterText, NestingThatNobodyWritesIsRefused) {
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

TEST(FilterText, RandomBytesAreRefusedWithAPlaceInsideTheText) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (int n = random.integer(0, 24); n > 0; --n)
      text += static_cast<char>(random.integer(0, 255));
    expect_place_inside(text);
    complete_filter(text, static_cast<std::size_t>(random.integer(0, 30)));
  }
}

TEST(FilterText, RandomWordsAreAcceptedOrRefusedWithAPlaceInsideTheText) {
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

TEST(FilterManual, HasEveryNameAndTheMethodsOptionsStandWithThem) {
  std::stringstream manual;
  for (const char* page : {"filter.md", "method.md"})
    manual << std::ifstream(std::string(PLANESCOPE_SOURCE_DIR "/docs/") + page).rdbuf();
  for (const FilterName& name : filter_names())
    EXPECT_NE(manual.str().find("`" + name.name + "`"), std::string::npos) << name.name;
}

}  // namespace
}  // namespace planescope::debug
