#include <cmath>
#include <vector>

#include "core/labels/model/label_json.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

template <typename T>
std::string size_of(const Image<T>& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height);
}

void check_sizes(const FrameLabels& labels, const std::string& where) {
  const Intrinsics& k = labels.intrinsics;
  if (labels.plane.empty() || labels.plane.channels != 1 || labels.hv.channels != 1) {
    throw Error(where + ": expected a plane image and an h/v image of one channel each");
  }
  if (labels.hv.width != labels.plane.width || labels.hv.height != labels.plane.height) {
    throw Error(where + ": the plane image is " + size_of(labels.plane) + ", the h/v image " +
                size_of(labels.hv));
  }
  if (labels.plane.width != k.width || labels.plane.height != k.height) {
    throw Error(where + ": the label images are " + size_of(labels.plane) +
                ", the intrinsics are for " + std::to_string(k.width) + "x" +
                std::to_string(k.height));
  }
}

void check_numbers(const FrameLabels& labels, const std::string& where) {
  const Intrinsics& k = labels.intrinsics;
  bool finite = labels.gravity.direction.allFinite() && std::isfinite(labels.gravity.confidence);
  for (const double value : {k.fx, k.fy, k.cx, k.cy}) finite = finite && std::isfinite(value);
  for (const double value : k.coefficients) finite = finite && std::isfinite(value);
  for (const LabelPlane& plane : labels.planes) {
    finite = finite && plane.normal.allFinite() && std::isfinite(plane.offset_m) &&
             std::isfinite(plane.rms_m) && std::isfinite(plane.tolerance_m) &&
             std::isfinite(plane.confidence);
  }
  if (!finite) throw Error(where + ": a number is not finite");
  for (const LabelPlane& plane : labels.planes) {
    if (plane.confidence < 0 || plane.confidence > 1) {
      throw Error(where + ": plane " + std::to_string(plane.id) + " has confidence " +
                  std::to_string(plane.confidence) + ", expected 0..1");
    }
    if (plane.fragments < 0) {
      throw Error(where + ": plane " + std::to_string(plane.id) + " has " +
                  std::to_string(plane.fragments) + " fragments, expected 0 or more");
    }
  }
}

void check_review(const FrameLabels& labels, const std::string& where) {
  const std::size_t pixels = labels.plane.pixels();
  for (const ReviewNote& note : labels.review) {
    if (note.pixel >= pixels || note.pixels > pixels) {
      throw Error(where + ": a review note about " + std::to_string(note.pixels) +
                  " pixels at pixel " + std::to_string(note.pixel) + ", the image has " +
                  std::to_string(pixels));
    }
    if (note.label_plane < 0 || note.other_plane < 0) {
      throw Error(where + ": a review note about planes " + std::to_string(note.label_plane) +
                  " and " + std::to_string(note.other_plane) + ", expected 0 or more");
    }
  }
}

void check_ids(const FrameLabels& labels, const std::string& where) {
  std::vector<bool> listed(kPlaneIgnore + 1, false);
  listed[0] = listed[kPlaneIgnore] = true;
  for (const LabelPlane& plane : labels.planes) {
    if (plane.id < 1 || plane.id >= kPlaneIgnore) {
      throw Error(where + ": plane id " + std::to_string(plane.id) + ", expected 1..65534");
    }
    if (listed[plane.id]) {
      throw Error(where + ": plane id " + std::to_string(plane.id) + " is listed twice");
    }
    listed[plane.id] = true;
  }
  for (const std::uint16_t id : labels.plane.data) {
    if (!listed[id]) {
      throw Error(where + ": plane id " + std::to_string(id) +
                  " is in the image but not in the list of planes");
    }
  }
  for (const std::uint8_t value : labels.hv.data) {
    if (value > 2 && value != kHvIgnore) {
      throw Error(where + ": h/v value " + std::to_string(value) + ", expected 0, 1, 2 or 255");
    }
  }
}

}  // namespace

void check_labels(const FrameLabels& labels, const std::string& where) {
  check_sizes(labels, where);
  check_numbers(labels, where);
  check_ids(labels, where);
  check_review(labels, where);
}

}  // namespace planescope::labels
