#include "core/explain/score.hpp"
