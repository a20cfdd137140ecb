#pragma once

// What the tests of the label store share.

#include <filesystem>
#include <string>

#include "core/labels/store/store.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

namespace planescope::labels {

inline std::filesystem::path fresh_dir(const std::string& name) {
  const auto dir = std::filesystem::path(testing::TempDir()) / ("label_store_" + name);
  std::filesystem::remove_all(dir);
  return dir;
}

inline FrameLabels blank(int frame) {
  FrameLabels labels = blank_labels(23, 17, static_cast<char>('a' + frame));
  labels.annotator = "ann";
  return labels;
}

inline LabelStoreOptions by(const std::string& annotator) { return {annotator, {}}; }

/// A random gesture that changes something, on a frame that is open.
inline void gesture(LabelStore& store, int frame, Random& random) {
  const auto before = store.labels(frame);
  LabelEdit edit;
  while (edit.empty()) {
    edit = make_edit(frame, "gesture", *before, after_random_gesture(*before, random));
  }
  store.commit(edit);
}

}  // namespace planescope::labels
