#include "core/lab/bench/table.hpp"

#include <gtest/gtest.h>

namespace planescope::lab {
namespace {

const Table kTable{"Sizes", "In metres.", {"what", "long", "wide"}, {{"a", "1.5", "10.25"}}, 1};

TEST(Table, IsAlignedInText) {
  EXPECT_EQ(to_text(kTable),
            "Sizes\n"
            "what  long   wide\n"
            "a      1.5  10.25\n"
            "In metres.\n");
}

TEST(Table, IsAMarkdownTableUnderAHeading) {
  EXPECT_EQ(to_markdown(kTable),
            "### Sizes\n\n"
            "| what | long |  wide |\n"
            "|---|---:|---:|\n"
            "| a    |  1.5 | 10.25 |\n"
            "\nIn metres.\n");
}

}  // namespace
}  // namespace planescope::lab
