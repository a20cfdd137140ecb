#include "core/planes/segment/options.hpp"

#include "core/model/error.hpp"

namespace planescope::planes {

const char* to_string(Profile profile) {
  switch (profile) {
    case Profile::paper:
      return "paper";
    case Profile::paper_closest:
      return "paper-closest";
    case Profile::refined:
      return "refined";
  }
  return "?";
}

Profile parse_profile(const std::string& text) {
  for (const Profile p : {Profile::paper, Profile::paper_closest, Profile::refined})
    if (text == to_string(p)) return p;
  throw Error("profile '" + text + "' is unknown, expected paper, paper-closest or refined");
}

SegmentOptions profile_options(Profile profile) {
  SegmentOptions o;
  o.profile = profile;
  switch (profile) {
    case Profile::paper:
      break;  // the struct's own defaults are the text as written
    case Profile::paper_closest:
      // The reading that comes closest to the paper's printed noise table.
      o.cube_anchor = CubeAnchor::min_corner;
      o.criterion4_n2 = false;
      o.merge_offset_m = 0.02;
      o.theta_n_in = 10;
      o.leftover_distance_m = 0.01;
      break;
    case Profile::refined:
      break;
  }
  return o;
}

}  // namespace planescope::planes
