#include "core/explain/explain.hpp"
