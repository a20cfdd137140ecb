#include "core/report/compare/terrain_changes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/model/text.hpp"

namespace planescope::report {
namespace {

/// Null: not known.
const Terrain* terrain_of(const ReportFrame* frame) {
  return frame && frame->terrain ? &*frame->terrain : nullptr;
}

/// Of a plane by its id; null where there is none, or no foot was given.
const FootRoom* foot_of(const ReportFrame& frame, int id) {
  if (id < 1) return nullptr;
  const std::optional<Footing>& footing = frame.planes.at(static_cast<std::size_t>(id) - 1).footing;
  return footing && footing->foot ? &*footing->foot : nullptr;
}

/// Empty: nothing became of it.
std::string steppable_change(const FrameComparison& frame, const PlaneComparison& plane) {
  const FootRoom* was = foot_of(*frame.baseline, plane.baseline);
  const FootRoom* is = foot_of(*frame.now, plane.now);
  const bool then = was && was->steppable, now = is && is->steppable;
  if (then == now) return "";
  if (now) return fmt::format("plane {} is steppable, which it was not", plane.now);
  if (!is)
    return fmt::format("the baseline's plane {}, which was steppable, is gone", plane.baseline);
  return fmt::format("plane {} is no longer steppable: {}", plane.now, is->why_not);
}

template <typename Thing>
std::string texts_of(const std::vector<Thing>& things) {
  std::vector<std::string> texts;
  for (const Thing& thing : things) texts.push_back(text_of(thing));
  return fmt::format("{}", fmt::join(texts, " and "));
}

/// "1 kerb: 100 mm in the baseline, none now".
std::string then_and_now(const std::string& was, const std::string& is) {
  if (was == is) return "";
  return fmt::format("{} in the baseline, {} now", was.empty() ? "none" : was,
                     is.empty() ? "none" : is);
}

std::string sentence(const std::string& start, const std::string& text) {
  std::string all = start + text + ".";
  all.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(all.front())));
  return all;
}

std::string without_gravity(const ReportFrame& frame) {
  return frame.gravity.known() ? "" : ": gravity is not known";
}

}  // namespace

std::string flights_change(const FrameComparison& frame) {
  const Terrain *was = terrain_of(frame.baseline), *is = terrain_of(frame.now);
  if (!was || !is) return "";
  return then_and_now(texts_of(was->flights), texts_of(is->flights));
}

std::vector<std::string> steppable_changes(const FrameComparison& frame) {
  const Terrain *was = terrain_of(frame.baseline), *is = terrain_of(frame.now);
  if (!was || !is || std::isnan(was->steppable_area_m2) || std::isnan(is->steppable_area_m2))
    return {};
  const auto area = [](const Terrain* of) {
    return fmt::format("{:.2f} m2", of->steppable_area_m2);
  };
  std::vector<std::string> changes;
  if (std::string text = then_and_now(area(was), area(is)); !text.empty())
    changes.push_back(std::move(text));
  for (const PlaneComparison& plane : frame.planes)
    if (std::string text = steppable_change(frame, plane); !text.empty())
      changes.push_back(std::move(text));
  return changes;
}

std::vector<std::string> terrain_changes(const FrameComparison& frame) {
  std::vector<std::string> sentences;
  for (const std::string& change : steppable_changes(frame))
    sentences.push_back(
        sentence(std::isdigit(static_cast<unsigned char>(change.front())) ? "steppable area: " : "",
                 change));
  if (const std::string change = flights_change(frame); !change.empty())
    sentences.push_back(sentence("stairs: ", change));
  const Terrain *was = terrain_of(frame.baseline), *is = terrain_of(frame.now);
  if (!was || !is) return sentences;
  const auto add = [&](const char* start, const auto& then, const auto& now) {
    if (const std::string change = then_and_now(texts_of(then), texts_of(now)); !change.empty())
      sentences.push_back(sentence(start, change));
  };
  add("kerbs: ", was->kerbs, is->kerbs);
  add("ramps: ", was->ramps, is->ramps);
  return sentences;
}

std::string steppable_text(const ReportFrame& frame) {
  const auto steppable = std::ranges::count_if(frame.planes, [](const ReportPlane& plane) {
    return plane.footing && plane.footing->foot && plane.footing->foot->steppable;
  });
  return fmt::format("{} of {} steppable{}", steppable, counted(frame.planes.size(), "plane"),
                     without_gravity(frame));
}

std::string flights_text(const ReportFrame& frame) {
  return frame.terrain->flights.empty() ? "no stairs are found" + without_gravity(frame)
                                        : texts_of(frame.terrain->flights);
}

}  // namespace planescope::report
