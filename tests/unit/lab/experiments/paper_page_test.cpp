#include "core/lab/experiments/paper_page.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "core/lab/experiments/paper_tables.hpp"

using namespace planescope;

namespace {

bool has(const std::string& page, const std::string& text) {
  return page.find(text) != std::string::npos;
}

lab::Cell cell(const std::string& set,
               double noise_cm,
               const std::string& method,
               const std::string& profile,
               double alpha_deg,
               double iou) {
  lab::Cell cell;
  cell.key = {.set = set,
              .seed = 1,
              .points = 8192,
              .noise_cm = noise_cm,
              .errors = "",
              .method = method,
              .profile = profile,
              .classifier = method == "ours" ? "gcn" : "",
              .setting = ""};
  cell.frames = 100;
  cell.metrics.planes_truth = cell.metrics.planes_found = 800;
  cell.metrics.r_p = 100;
  cell.metrics.alpha_deg = alpha_deg;
  cell.metrics.mean_iou = iou;
  return cell;
}

lab::PaperResults some_results() {
  lab::PaperResults results;
  results.command = "planescope-lab bench paper --count '<few>'";
  results.build = {"0.1.0", "0123456789abcdef", true};
  results.weights.file = "own & others.safetensors";
  results.weights.sha256 = "feed";
  for (const double noise : {0.0, 0.1, 0.2, 0.3}) {
    results.cells.push_back(cell("stairs", noise, "ours", "paper", 1 + 40 * noise, 90));
    results.cells.push_back(cell("stairs", noise, "ours", "refined", 0.2 * noise, 97));
    results.cells.push_back(cell("stairs", noise, "ransac", "", noise, 95));
    results.cells.push_back(cell("stairs", noise, "oracle", "", 0.1 * noise, 99));
  }
  return results;
}

lab::PaperTimings some_timings() {
  lab::PaperTimings timings;
  timings.machine.cpu = "A <quick> CPU";
  timings.classifiers = {{"gcn", 2048, 1, 1.5}, {"gcn", 4096, 1, 2.5}, {"gcn", 8192, 1, 4.5}};
  return timings;
}

lab::PaperPicture picture(const std::string& row, const std::string& column) {
  lab::PaperPicture picture;
  picture.row = row;
  picture.column = column;
  picture.caption = row + " < " + column;
  picture.copy = {1, 2, 3};
  picture.width = 640;
  picture.height = 480;
  return picture;
}

std::vector<lab::PaperFigure> some_figures() {
  lab::PaperFigure figure;
  figure.id = "stairs_noise";
  figure.title = "Stairs & noise";
  figure.note = "a note";
  figure.pictures = {picture("paper", "0.0"), picture("paper", "0.3"), picture("refined", "0.3")};
  return {figure, lab::PaperFigure{"failures", "Where planes are lost", "", {}}};
}

/// The first element that is not closed in the order in which elements were opened; empty: all are.
std::string unbalanced(const std::string& page) {
  static const std::regex tag("<(/?)([a-zA-Z][a-zA-Z0-9]*)(?:\"[^\"]*\"|[^>\"])*?(/?)>");
  std::vector<std::string> open;
  for (auto i = std::sregex_iterator(page.begin(), page.end(), tag); i != std::sregex_iterator();
       ++i) {
    const std::string name = (*i)[2];
    const bool is_void = name == "meta" || name == "link" || name == "img";
    if (is_void || (*i)[3] == "/") continue;
    if ((*i)[1] != "/") {
      open.push_back(name);
    } else {
      if (open.empty() || open.back() != name) return (*i).str();
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

class PaperPage : public testing::Test {
 protected:
  const lab::PaperResults results_ = some_results();
  const lab::PaperTimings timings_ = some_timings();
  const std::vector<lab::PaperFigure> figures_ = some_figures();
  const std::string page_ = lab::paper_page(results_, &timings_, figures_);
};

}  // namespace

TEST_F(PaperPage, ShowsEveryTableAndEveryClaim) {
  std::vector<lab::Table> tables = lab::paper_tables(results_);
  for (const lab::Table& table : lab::stricter_tables(results_)) tables.push_back(table);
  for (const lab::Table& table : lab::timing_tables(timings_)) tables.push_back(table);
  ASSERT_GE(tables.size(), 3u);
  for (const lab::Table& table : tables)
    EXPECT_TRUE(has(page_, ">" + table.title + "<")) << table.title;
  for (const lab::Claim& claim : lab::claims(results_)) EXPECT_TRUE(has(page_, claim.measure));
}

TEST_F(PaperPage, SaysWhatWasRunAndEscapesIt) {
  for (const char* text :
       {"planescope-lab bench paper --count", "&lt;few&gt;", "0123456789abcdef", "with changes",
        "own &amp; others.safetensors", "feed", "A &lt;quick&gt; CPU", "Stairs &amp; noise"})
    EXPECT_TRUE(has(page_, text)) << text;
  for (const char* text : {"<few>", "<quick>", "own & others"}) EXPECT_FALSE(has(page_, text));
}

TEST_F(PaperPage, IsWellFormedAndNeedsNothingBesideIt) {
  EXPECT_EQ(unbalanced(page_), "");
  for (const char* text : {"http:", "https:", "<script", "@import", "url("})
    EXPECT_FALSE(has(page_, text)) << text;
  EXPECT_FALSE(std::regex_search(page_, std::regex("(src|href)=\"(?!data:|#)")));
}

TEST_F(PaperPage, DrawsOursBesideThePrintedCurveAndTheRivals) {
  for (const char* name : {">printed<", ">paper<", ">refined<", ">RANSAC 0.01 m<", ">oracle<"})
    EXPECT_TRUE(has(page_, name)) << name;
  EXPECT_FALSE(has(page_, ">RANSAC 0.02 m<")) << "was not measured";
  EXPECT_FALSE(has(page_, "nan"));
}

TEST_F(PaperPage, PutsPicturesWhereTheirRowAndColumnMeet) {
  EXPECT_TRUE(has(page_, "data:image/webp;base64,AQID"));
  for (const char* place : {"id=\"stairs_noise-0\" style=\"grid-row:2;grid-column:2\"",
                            "id=\"stairs_noise-1\" style=\"grid-row:2;grid-column:3\"",
                            "id=\"stairs_noise-2\" style=\"grid-row:3;grid-column:3\""})
    EXPECT_TRUE(has(page_, place)) << place;
  EXPECT_FALSE(has(page_, "Where planes are lost")) << "a figure without pictures";
}

TEST_F(PaperPage, IsThereBeforeAnythingWasMeasured) {
  const std::string page = lab::paper_page(lab::PaperResults{}, nullptr, {});
  EXPECT_EQ(unbalanced(page), "");
  EXPECT_FALSE(has(page, "<svg"));
}
