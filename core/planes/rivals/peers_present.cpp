// Beside peers_pcl.cpp and peers_cgal.cpp in builds with -DPLANESCOPE_PEERS=ON.

#include "core/planes/rivals/peers.hpp"

namespace planescope::planes {

bool has_peers() { return true; }

}  // namespace planescope::planes
