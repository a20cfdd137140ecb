#pragma once

// Figures of cells as text. Internal to core/lab/experiments.

#include <fmt/format.h>

#include <optional>
#include <span>
#include <string>

#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

inline std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

inline double percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0; }

/// Several sets as one: means over all their frames, counts added up. nullopt where one of them
/// was not measured.
std::optional<Cell> joined_cell(const PaperResults& results, std::span<const CellKey> keys);

}  // namespace planescope::lab
