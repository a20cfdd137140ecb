#pragma once

#include <string>

namespace planescope {

/// `text` where it `fits(text)`, else as much of its beginning as fits with an ellipsis behind it.
template <typename Fits>
std::string shortened(const std::string& text, const Fits& fits) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; };
  if (fits(text)) return text;
  std::string kept = text;
  while (!kept.empty()) {
    while (kept.size() > 1 && continues(kept.back())) kept.pop_back();  // UTF-8
    kept.pop_back();
    if (fits(kept + "…")) break;
  }
  return kept + "…";
}

}  // namespace planescope
