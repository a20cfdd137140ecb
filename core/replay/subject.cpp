#include "core/replay/subject.hpp"
