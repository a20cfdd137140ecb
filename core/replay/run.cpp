#include "core/replay/run.hpp"
