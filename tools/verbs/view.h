#pragma once

#include "tools/verbs/arguments.h"

#include <string>

namespace fluidcarve {

/// The same document with a node `view` of type preview.page, or with the one that it has.
/// @param name  becomes the name of the node
/// @return what is wrong, if the pipeline has nothing to show; else empty
std::string add_page(Document& document, std::string& name);

/// Lets a node of type preview.page write another file.
void set_page_path(Document& document, const std::string& node, const std::string& path);

/// The file that a node of type preview.page writes.
std::string page_path(const Pipeline& pipeline, const std::string& node);

}  // namespace fluidcarve
