#include "core/replay/filter.hpp"
