#pragma once

#include <string>

namespace planescope::report {

/// One HTML page that needs nothing beside it, light and dark as the reader's system is, with the
/// style of charts. `body`: HTML below the title, which is escaped here.
std::string plain_page(const std::string& title, const std::string& body);

}  // namespace planescope::report
