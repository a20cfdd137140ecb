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

/// The CMake option without which this program was built, and so without the method; null where it
/// has it.
const char* missing_option(Method method) {
  if (method == Method::ransac) return has_ransac() ? nullptr : "PLANESCOPE_OPEN3D";
  if (method > Method::region_growing) return has_pcl_and_cgal() ? nullptr : "PLANESCOPE_RIVALS";
  return nullptr;
}

}  // namespace

const char* to_string(Method method) { return kMethods[static_cast<std::size_t>(method)].name; }

const std::vector<Method>& all_methods() {
  static const std::vector<Method> methods = [] {
    std::vector<Method> all;
    for (const NamedMethod& named : kMethods) all.push_back(named.method);
    return all;
  }();
  return methods;
}

const std::vector<Method>& built_methods() {
  static const std::vector<Method> methods = [] {
    std::vector<Method> built;
    for (const NamedMethod& named : kMethods)
      if (!missing_option(named.method)) built.push_back(named.method);
    return built;
  }();
  return methods;
}

Method parse_method(const std::string& text) {
  std::string known;
  for (const auto& [method, name] : kMethods) {
    const char* missing = missing_option(method);
    if (text == name && missing)
      throw Error("method '" + text + "' is in builds with -D" + missing +
                  "=ON alone, see docs/method.md");
    if (text == name) return method;
    if (!missing) known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw Error("method '" + text + "' does not exist, expected one of " + known);
}

}  // namespace planescope::planes
