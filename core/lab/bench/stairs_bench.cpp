#include "core/lab/bench/stairs_bench.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/lab/bench/result_json.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::lab {
namespace {

constexpr const char* kSets[] = {"depth_stairs", "depth_descent", "depth_boxes"};

StairsFrame measure_frame(const EvaluationFrame& made,
                          const planes::PipelineOptions& options,
                          const planes::Classifier& classifier) {
  StairsFrame row;
  row.name = made.name;
  row.rise_error_m = row.going_error_m = std::numeric_limits<double>::quiet_NaN();
  if (made.stairs) {
    const std::vector<SeenStep> seen = seen_steps(made, options.cloud.max_range_m);
    row.seen = steps_in_sequence(seen, kSeenPixels);
    row.seen_least = steps_in_sequence(seen, kSurelySeenPixels);
    row.seen_most = steps_in_sequence(seen, kBarelySeenPixels);
    row.has_stairs = row.seen_least >= 2;
    row.true_rise_m = made.stairs->rise_m;
    row.true_going_m = made.stairs->going_m;
  }
  const planes::Stairs found = planes::analyze(made.frame, options, &classifier).found.stairs;
  row.flights = static_cast<int>(found.flights.size());
  if (found.flights.empty()) return row;
  const planes::Flight& flight = found.flights.front();
  row.found = static_cast<int>(flight.steps.size());
  if (made.stairs) {
    row.rise_error_m = flight.rise_m - made.stairs->rise_m;
    row.going_error_m = flight.going_m - made.stairs->going_m;
  }
  return row;
}

/// How many of the frames that have stairs are within a bar.
int within(const StairsOfSet& set, double StairsFrame::*error, double bar_m) {
  return static_cast<int>(std::ranges::count_if(set.frames, [&](const StairsFrame& frame) {
    return frame.has_stairs && std::abs(frame.*error) <= bar_m;
  }));
}

/// Of the absolute errors that there are, at a share; NaN where there are none [m].
double percentile(const StairsOfSet& set, double StairsFrame::*error, double share) {
  std::vector<double> errors;
  for (const StairsFrame& frame : set.frames)
    if (frame.has_stairs && !std::isnan(frame.*error)) errors.push_back(std::abs(frame.*error));
  if (errors.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(errors);
  return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
}

int count_of(const StairsOfSet& set, const std::function<bool(const StairsFrame&)>& is) {
  return static_cast<int>(std::ranges::count_if(set.frames, is));
}

}  // namespace

std::vector<StairsOfSet> measure_stairs(const StairsBenchOptions& options,
                                        const planes::Classifier& classifier,
                                        const std::function<void(int, int)>& progress) {
  std::vector<StairsOfSet> sets;
  for (const char* name : kSets)
    sets.push_back({name, std::vector<StairsFrame>(static_cast<std::size_t>(options.count))});
  planes::PipelineOptions pipeline = options.pipeline;
  pipeline.threads = 1;
  const EvaluationOptions frames{.seed = options.seed, .errors = DepthErrors::d435};
  const auto measure = [&](int i) {
    StairsOfSet& set = sets[static_cast<std::size_t>(i / options.count)];
    const int index = i % options.count;
    set.frames[static_cast<std::size_t>(index)] = measure_frame(
        make_evaluation_frame(find_evaluation_set(set.set), index, frames), pipeline, classifier);
  };
  work_through(options.count * static_cast<int>(sets.size()), options.pipeline.threads, measure,
               progress);
  return sets;
}

std::vector<Table> stairs_tables(const std::vector<StairsOfSet>& sets) {
  Table flights;
  flights.title = "Stairs by the D435's errors";
  flights.note = fmt::format(
      "A step is seen where {} pixels of its tread were measured within the range, and as many of "
      "the level before it, within one going. with: frames in which at least two steps in sequence "
      "have {}. number: frames with the right number of steps: from those in sequence that have {} "
      "to "
      "those that have {}, none where these are fewer than two; strict: just those that have {}. "
      "rise, going: frames with stairs whose flight is within {:.0f} and {:.0f} mm in the mean; "
      "50 %, 95 %: of the absolute errors where a flight was found [mm].",
      kSeenPixels, kSurelySeenPixels, kSurelySeenPixels, kBarelySeenPixels, kSeenPixels,
      1000 * kRiseBarM, 1000 * kGoingBarM);
  flights.columns = {"set",  "frames", "with",      "number [%]", "strict [%]", "rise [%]",
                     "50 %", "95 %",   "going [%]", "50 %",       "95 %"};
  Table none;
  none.title = "Flights where there are none";
  none.note =
      fmt::format("Frames in which no two steps in sequence have {} pixels, and the flights found.",
                  kBarelySeenPixels);
  none.columns = {"set", "frames", "flights"};
  for (const StairsOfSet& set : sets) {
    const int frames = static_cast<int>(set.frames.size());
    const int with = count_of(set, [](const StairsFrame& f) { return f.has_stairs; });
    const auto mm = [&](double StairsFrame::*error, double share) {
      return fixed(1000 * percentile(set, error, share), 1);
    };
    if (with > 0)
      flights.rows.push_back(
          {set.set, fmt::format("{}", frames), fmt::format("{}", with),
           fixed(percent(count_of(set, &StairsFrame::right), frames), 1),
           fixed(percent(count_of(set,
                                  [](const StairsFrame& f) {
                                    return f.found == (f.seen < 2 ? 0 : f.seen);
                                  }),
                         frames),
                 1),
           fixed(percent(within(set, &StairsFrame::rise_error_m, kRiseBarM), with), 1),
           mm(&StairsFrame::rise_error_m, 0.5), mm(&StairsFrame::rise_error_m, 0.95),
           fixed(percent(within(set, &StairsFrame::going_error_m, kGoingBarM), with), 1),
           mm(&StairsFrame::going_error_m, 0.5), mm(&StairsFrame::going_error_m, 0.95)});
    int without = 0, found = 0;
    for (const StairsFrame& frame : set.frames)
      if (frame.seen_most < 2) ++without, found += frame.flights;
    if (without > 0)
      none.rows.push_back({set.set, fmt::format("{}", without), fmt::format("{}", found)});
  }
  return {flights, none};
}

std::string stairs_bench_json(const StairsRun& run) {
  using Json = nlohmann::ordered_json;
  Json facts =
      run_json("planescope.bench.stairs/1", run.command, report::build_info(), run.weights);
  facts["seed"] = run.options.seed;
  facts["count"] = run.options.count;
  facts["max_range_m"] = run.options.pipeline.cloud.max_range_m;
  facts["least_px"] = kSeenPixels;
  JsonLines lines(facts);
  for (const StairsOfSet& set : run.sets) {
    std::vector<std::string> frames;
    for (const StairsFrame& frame : set.frames)
      frames.push_back(json_line(Json{{"frame", frame.name},
                                      {"seen", frame.seen},
                                      {"seen_least", frame.seen_least},
                                      {"seen_most", frame.seen_most},
                                      {"found", frame.found},
                                      {"flights", frame.flights},
                                      {"rise_m", frame.true_rise_m},
                                      {"going_m", frame.true_going_m},
                                      {"rise_error_m", frame.rise_error_m},
                                      {"going_error_m", frame.going_error_m}}));
    lines.add(set.set, frames);
  }
  return std::move(lines).text();
}

}  // namespace planescope::lab
