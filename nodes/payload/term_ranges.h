#pragma once

namespace fluidcarve {

class Registry;

/// Registers the payload type `ranges`.
void add_ranges_payload(Registry& registry);

}  // namespace fluidcarve
