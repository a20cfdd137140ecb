#pragma once

#include <memory>

#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

/// PCA normals as they are commonly computed, nanoflann's k-d tree for the neighbours and Eigen's
/// closed form for the normal: what our classifiers' speed is held against. Labels differ from
/// those of make_pca_classifier() where several points are equally far, or a normal lies at the
/// boundary.
std::unique_ptr<Classifier> make_nanoflann_pca_classifier(const PcaClassifierOptions& options = {});

}  // namespace planescope::planes
