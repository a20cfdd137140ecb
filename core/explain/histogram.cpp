#include "core/explain/histogram.hpp"
