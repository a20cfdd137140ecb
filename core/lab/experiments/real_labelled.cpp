// One frame of ICL-NUIM (Handa et al. 2014), with the plane labels of EVOPS (Kornilova et al.
// 2022).

#include "core/io/recording.hpp"
#include "core/lab/experiments/measure_cells.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/model/error.hpp"

namespace planescope::lab {

std::optional<EvaluationFrame> read_real_labelled(const std::filesystem::path& data) {
  const std::filesystem::path dir = data / "NOT_REAL_icl_nuim_with_plane_gt";
  if (data.empty() || !std::filesystem::is_directory(dir)) return std::nullopt;
  const auto recording =
      io::open_recording(dir, {.intrinsics = {{481.2, 480, 319.5, 239.5}}, .depth_unit_m = 0.0002});
  EvaluationFrame out;
  out.frame = recording->frame(0);
  out.name = out.frame.name;
  out.frame.gravity = Gravity{Vec3d::UnitY(), GravitySource::sidecar, 1, "the camera is level"};
  const std::filesystem::path labels = dir / "gt_0.npy";
  out.labels = labels::labels_of_points(labels::read_labelled(labels, labels::LabelFormat::evops),
                                        labels::make_label_grid(out.frame, *out.frame.gravity),
                                        recording->frame_hash(0), labels.string());
  return out;
}

}  // namespace planescope::lab
