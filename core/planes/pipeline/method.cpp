#include "core/planes/pipeline/method.hpp"

#include <array>

#include "core/model/error.hpp"

namespace planescope::planes {
namespace {

struct NamedMethod {
  Method method;
  const char* name;
};
constexpr std::array kMethods = {NamedMethod{Method::ours, "ours"},
                                 NamedMethod{Method::ransac, "ransac"},
                                 NamedMethod{Method::region_growing, "region-growing"},
                                 NamedMethod{Method::pcl_multi_plane, "pcl-multi-plane"},
                                 NamedMethod{Method::pcl_region_growing, "pcl-region-growing"},
                                 NamedMethod{Method::cgal_ransac, "cgal-ransac"},
                                 NamedMethod{Method::cgal_region_growing, "cgal-region-growing"}};

bool is_peer(Method method) { return method > Method::region_growing; }

}  // namespace

const char* to_string(Method method) { return kMethods[static_cast<std::size_t>(method)].name; }

const std::vector<Method>& built_methods() {
  static const std::vector<Method> methods = [] {
    std::vector<Method> built;
    for (const NamedMethod& named : kMethods)
      if (!is_peer(named.method) || has_peers()) built.push_back(named.method);
    return built;
  }();
  return methods;
}

Method parse_method(const std::string& text) {
  std::string known;
  for (const auto& [method, name] : kMethods) {
    const bool built = !is_peer(method) || has_peers();
    if (text == name && built) return method;
    if (text == name)
      throw Error("method '" + text +
                  "' is in builds with -DPLANESCOPE_PEERS=ON alone, see docs/method.md");
    if (built) known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw Error("method '" + text + "' does not exist, expected one of " + known);
}

}  // namespace planescope::planes
