#include "core/classify/gcn.hpp"

#include "core/base/error.hpp"

namespace planescope {

std::unique_ptr<Classifier> make_gcn_classifier(const NetworkWeights&, const std::string& name) {
  throw Error("classifier " + name + ": not in this build");
}

}  // namespace planescope
