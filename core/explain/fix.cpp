#include "core/explain/fix.hpp"
