#include "core/explain/compare.hpp"
