#include <nlohmann/json.hpp>

#include "core/lab/bench/classifier_bench.hpp"

namespace planescope::lab {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const planes::LabelAccuracy& accuracy) {
  return {{"edge_percent", accuracy.edge_percent()},
          {"inner_percent", accuracy.inner_percent()},
          {"edge_points", accuracy.edge},
          {"inner_points", accuracy.inner}};
}

Json json_of(const SpeedRow& row) {
  Json json = {{"network", row.network}, {"points", row.points}, {"threads", row.threads}};
  for (const auto& [simd, ms] : row.network_ms) json["network_ms"][to_string(simd)] = ms;
  json["nanoflann_pca_ms"] = row.nanoflann_ms;
  json["own_pca_ms"] = row.pca_ms;
  json["nanoflann_pca_by_network"] = row.nanoflann_ratio;
  json["own_pca_by_network"] = row.pca_ratio;
  return json;
}

Json json_of(const ReferenceRow& row) {
  return {{"network", row.network},
          {"points", row.points},
          {"whole_ms", row.whole_ms},
          {"forward_ms", row.forward_ms},
          {"plain_ms", row.plain_ms},
          {"plain_by_whole", row.whole_ratio},
          {"plain_by_forward", row.forward_ratio}};
}

Json json_of(const FrameRow& row) {
  return {{"recording", row.recording},
          {"classifier", row.classifier},
          {"threads", row.threads},
          {"frames", row.frames},
          {"runs", row.runs},
          {"points", row.points},
          {"voxels", row.voxels},
          {"planes", row.planes},
          {"load_ms", row.ms.load_ms},
          {"cloud_ms", row.ms.cloud_ms},
          {"t_d_ms", row.ms.t_d_ms},
          {"t_c_ms", row.ms.t_c_ms},
          {"t_b_ms", row.ms.t_b_ms},
          {"t_s_ms", row.ms.t_s_ms},
          {"fps", row.fps},
          {"fps_with_cloud", row.whole_fps}};
}

std::string text_of(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string results_json(const ClassifierBench& bench) {
  Json json = {{"schema", "planescope.bench_classifier/1"},
               {"seed", bench.labels.seed},
               {"count", bench.labels.count}};
  json["networks"] = Json::array();
  for (const auto& [name, record] : bench.networks)
    json["networks"].push_back({{"name", name},
                                {"file", record.file},
                                {"sha256", record.sha256},
                                {"network", record.network},
                                {"training", Json::parse(record.training)}});
  if (bench.gravity) json["tilt_deg"] = bench.labels.tilt_deg;
  for (const LabelRow& row : bench.label_rows) {
    Json entry = {{"clouds", row.set}, {"classifier", row.classifier}};
    entry["level"] = json_of(row.level);
    if (bench.gravity) entry["tilted"] = json_of(row.tilted);
    json["labels"].push_back(entry);
  }
  for (const ChainRow& row : bench.chain_rows)
    json["chain"].push_back({{"noise_cm", row.noise_cm},
                             {"labels", row.labels},
                             {"planes_true", row.metrics.planes_truth},
                             {"planes_found", row.metrics.planes_found},
                             {"r_p", row.metrics.r_p},
                             {"point_accuracy", row.metrics.point_accuracy},
                             {"alpha_deg", row.metrics.alpha_deg},
                             {"r_m", row.metrics.r_m}});
  return text_of(json);
}

std::string timings_json(const ClassifierBench& bench) {
  Json json = {{"schema", "planescope.bench_classifier.timings/1"},
               {"command", bench.command},
               {"machine",
                {{"cpu", bench.machine.cpu},
                 {"cores", bench.machine.cores},
                 {"simd", to_string(bench.machine.simd)}}}};
  if (bench.speed) {
    json["seed"] = bench.speed_options.seed;
    json["rounds"] = bench.speed_options.rounds;
    for (const SpeedRow& row : bench.speed->speed) json["speed"].push_back(json_of(row));
    for (const ReferenceRow& row : bench.speed->reference)
      json["reference"].push_back(json_of(row));
  }
  for (const FrameRow& row : bench.frame_rows) json["frames"].push_back(json_of(row));
  return text_of(json);
}

}  // namespace planescope::lab
