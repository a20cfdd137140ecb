#include <fmt/format.h>

#include "core/planes/stairs/stairs.hpp"

namespace planescope::planes {
namespace {

std::string cm(double m) { return fmt::format("{:.0f} cm", 100 * m); }

std::string told(const StepDecision& d) {
  switch (d.why) {
    case NoStep::rise:
      return fmt::format("no step: rise {}, limit {}", cm(d.value), cm(d.limit));
    case NoStep::apart:
      return fmt::format("no step: {} apart, limit {}", cm(d.value), cm(d.limit));
    case NoStep::narrow:
      return fmt::format("no step: {} wide, limit {}", cm(d.value), cm(d.limit));
    case NoStep::crooked:
      return fmt::format("no step: {:.0f} % of the border is straight, limit {:.0f} %",
                         100 * d.value, 100 * d.limit);
    case NoStep::rise_uneven:
      return fmt::format("not of the flight below: rises differ by {}, limit {}", cm(d.value),
                         cm(d.limit));
    case NoStep::going:
      return fmt::format("not of the flight below: going {}, limit {}", cm(d.value), cm(d.limit));
    case NoStep::going_uneven:
      return fmt::format("not of the flight below: goings differ by {}, limit {}", cm(d.value),
                         cm(d.limit));
    case NoStep::alone:
      return fmt::format("a step alone: {} wide, limit for a kerb {}", cm(d.value), cm(d.limit));
    case NoStep::shallow:
      break;
  }
  return fmt::format("a step alone: {} deep, limit for a kerb {}", cm(d.value), cm(d.limit));
}

}  // namespace

const char* to_string(NoStep why) {
  switch (why) {
    case NoStep::rise:
      return "rise";
    case NoStep::apart:
      return "apart";
    case NoStep::narrow:
      return "narrow";
    case NoStep::crooked:
      return "crooked";
    case NoStep::rise_uneven:
      return "rise_uneven";
    case NoStep::going:
      return "going";
    case NoStep::going_uneven:
      return "going_uneven";
    case NoStep::alone:
      return "alone";
    case NoStep::shallow:
      break;
  }
  return "shallow";
}

std::string to_text(const StepDecision& decision) {
  return fmt::format("P{} -> P{} {}", decision.lower, decision.upper, told(decision));
}

}  // namespace planescope::planes
