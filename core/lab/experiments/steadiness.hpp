#pragma once

// How many of a frame's planes are kept under a change that means nothing, counted by pixel: the
// definitions of partner, self-PQ, lost and big.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::lab {

/// A plane's partner is the plane of the other image with the greatest IoU, if above this.
inline constexpr double kSteadyPartnerIou = 0.5;
/// Planes are the same from this IoU on.
inline constexpr double kSamePlaneIou = 0.99;
/// A plane with at least this many compared pixels is big.
inline constexpr std::uint64_t kBigPlanePixels = 3000;
/// Two frames see the same surface if their depths differ by less than this share.
inline constexpr double kDepthAgreement = 0.03;

/// How planes of the first image are found again in the second.
struct KeptPlanes {
  int planes = 0;      // of the first image, with at least one compared pixel
  int partners = 0;    // of those, with a partner
  double iou_sum = 0;  // over planes with a partner
  int big = 0, big_lost = 0;

  int lost() const { return planes - partners; }
};

struct Agreement {
  KeptPlanes all;
  KeptPlanes decided;        // the same, of the first image's decided planes only
  int second_planes = 0;     // of the second image, with at least one compared pixel
  int changed = 0;           // planes of the first image with no plane of IoU >= kSamePlaneIou
  std::vector<int> partner;  // by id - 1 of the first image; 0: none

  /// Sum of IoU over partners, by the mean number of planes of both images.
  double self_pq() const;
  /// The same of the decided planes, by their number.
  double decided_pq() const;
};

/// `first`, `second`: plane ids by pixel, 0 none; pixels with -1 in `first` are not compared.
/// `undecided`: by id - 1 of the first image; ids beyond its end are decided.
Agreement compare_planes_by_pixel(std::span<const std::int32_t> first,
                                  std::span<const std::int32_t> second,
                                  std::span<const std::uint8_t> undecided = {});

/// A depth image in meters.
struct DepthMeters {
  Intrinsics intrinsics;
  std::vector<double> depth_m;  // by pixel v * width + u; 0: not measured, or out of range
};
DepthMeters depth_meters(const Frame& frame, double max_range_m);

/// The first image's plane ids at the pixels where the second image sees the same surface; -1 at
/// all others. Lens distortion is ignored. `T_second_first`: between the cameras.
std::vector<std::int32_t> warp_planes(std::span<const std::int32_t> first_planes,
                                      const DepthMeters& first,
                                      const DepthMeters& second,
                                      const Pose& T_second_first);

/// The same without poses: pixel by pixel. Both images have the same size.
std::vector<std::int32_t> planes_in_place(std::span<const std::int32_t> first_planes,
                                          const DepthMeters& first,
                                          const DepthMeters& second);

}  // namespace planescope::lab
