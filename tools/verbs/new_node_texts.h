#pragma once

#include <map>
#include <string_view>

namespace fluidcarve {

/// Templates of these files, by name: tools/new_node/*.in. `{{family}}`, `{{name}}`, `{{Name}}`,
/// `{{type}}` and `{{folder}}` are placeholders.
const std::map<std::string_view, std::string_view>& new_node_texts();

}  // namespace fluidcarve
