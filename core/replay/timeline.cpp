#include "core/replay/timeline.hpp"
