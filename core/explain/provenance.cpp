#include "core/explain/provenance.hpp"
