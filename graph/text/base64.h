#pragma once

#include <string>
#include <string_view>

namespace fluidcarve {

/// Bytes as text: base64 with padding (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace fluidcarve
