#pragma once

#include "graph/types/node_type.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fluidcarve {

/// A page as one HTML file that loads nothing else.
/// @param scene  page_scene()
std::string page_html(const nlohmann::ordered_json& scene);

/// The node type preview.page.
NodeType preview_page();

}  // namespace fluidcarve
