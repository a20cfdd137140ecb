// paper.timings.json, "planescope.paper.timings/1".

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/io/json_file.hpp"
#include "core/lab/experiments/results.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.paper.timings/1";

Simd parse_simd(const std::string& text) {
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512})
    if (to_string(simd) == text) return simd;
  throw Error("instruction set '" + text + "' is not known");
}

}  // namespace

void write_timings(const std::filesystem::path& dir, const PaperTimings& timings) {
  Json json = {{"schema", kSchema},
               {"command", timings.command},
               {"machine",
                {{"cpu", timings.machine.cpu},
                 {"cores", timings.machine.cores},
                 {"simd", to_string(timings.machine.simd)}}},
               {"threads", timings.threads},
               {"classifiers", Json::array()},
               {"real", Json::array()},
               {"methods", Json::array()}};
  for (const ClassifierTiming& t : timings.classifiers)
    json["classifiers"].push_back({{"classifier", t.classifier},
                                   {"points", t.points},
                                   {"threads", t.threads},
                                   {"median_ms", t.median_ms}});
  for (const RealTiming& t : timings.real)
    json["real"].push_back({{"recording", t.recording},
                            {"frames", t.frames},
                            {"t_d_ms", t.t_d_ms},
                            {"t_c_ms", t.t_c_ms},
                            {"t_b_ms", t.t_b_ms},
                            {"t_s_ms", t.t_s_ms},
                            {"fps", t.fps}});
  for (const MethodTiming& t : timings.methods)
    json["methods"].push_back({{"set", t.key.set},
                               {"seed", t.key.seed},
                               {"points", t.key.points},
                               {"noise_cm", t.key.noise_cm},
                               {"method", t.key.method},
                               {"profile", t.key.profile},
                               {"classifier", t.key.classifier},
                               {"setting", t.key.setting},
                               {"fps", t.fps}});
  write_file_text(dir / "paper.timings.json",
                  json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

PaperTimings read_timings(const std::filesystem::path& dir) {
  const std::filesystem::path file = dir / "paper.timings.json";
  const auto json = io::read_json_file(file);
  try {
    const std::string schema = json.at("schema");
    if (schema != kSchema)
      throw Error(fmt::format("{}: schema is '{}', expected '{}'", file.string(), schema, kSchema));
    PaperTimings timings;
    timings.command = json.at("command");
    const auto& machine = json.at("machine");
    timings.machine = {machine.at("cpu"), machine.at("cores"), parse_simd(machine.at("simd"))};
    timings.threads = json.at("threads");
    for (const auto& t : json.at("classifiers"))
      timings.classifiers.push_back(
          {t.at("classifier"), t.at("points"), t.at("threads"), t.at("median_ms")});
    for (const auto& t : json.at("real"))
      timings.real.push_back({t.at("recording"), t.at("frames"), t.at("t_d_ms"), t.at("t_c_ms"),
                              t.at("t_b_ms"), t.at("t_s_ms"), t.at("fps")});
    for (const auto& t : json.at("methods")) {
      MethodTiming& method = timings.methods.emplace_back();
      method.key = {t.at("set"),    t.at("seed"),    t.at("points"),     t.at("noise_cm"), "",
                    t.at("method"), t.at("profile"), t.at("classifier"), t.at("setting")};
      method.fps = t.at("fps");
    }
    return timings;
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        fmt::format("{}: {}, expected timings of bench paper", file.string(), error.what()));
  }
}

}  // namespace planescope::lab
