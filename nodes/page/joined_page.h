#pragma once

#include "graph/types/page_joiner.h"

namespace fluidcarve {

/// Shows several pages in one: PageJoiner::write.
void write_joined_page(const std::string& title, const std::vector<PagePart>& parts, const std::string& path);

}  // namespace fluidcarve
