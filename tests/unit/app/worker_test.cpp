#include <gtest/gtest.h>

#include <future>

#include "app/desktop/jobs/request.hpp"

namespace planescope::desktop {
namespace {

TEST(Worker, WorkThatThrowsIsToldAndTheNextIsDone) {
  std::promise<std::string> told;
  std::promise<void> done;
  Worker worker([] {}, [&](const std::string& why) { told.set_value(why); });
  worker.replace([](std::stop_token) { throw std::bad_alloc(); });
  EXPECT_EQ(told.get_future().get(), "out of memory");
  worker.replace([&](std::stop_token) { done.set_value(); });
  done.get_future().get();
}

}  // namespace
}  // namespace planescope::desktop
