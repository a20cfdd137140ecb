#include "core/labels/exchange/exchange_files.hpp"
#include "core/labels/exchange/npy.hpp"

// EVOPS (https://github.com/MobileRoboticsSkoltech/EVOPS): a NumPy array with one plane id per
// point, 0 where there is none.
namespace planescope::labels {

FileBytes evops_bytes(const LabelledPoints& points) {
  // To every other reader 65535 would be one more plane.
  std::vector<std::int32_t> ids = points.instance;
  for (std::int32_t& id : ids)
    if (id == kPlaneIgnore) id = 0;
  return npy_bytes("<i4", {ids.size()}, std::as_bytes(std::span(ids)));
}

LabelledPoints parse_evops(io::Bytes file, const std::string& where) {
  const NpyArray array = parse_npy(file, where);
  if (array.shape.size() != 1)
    throw Error(where + ": an array of " + std::to_string(array.shape.size()) +
                " dimensions, expected one plane id per point");
  check_count(array.size(), where);
  LabelledPoints points;
  points.instance = instances_of(array.values(), where);
  return points;
}

}  // namespace planescope::labels
