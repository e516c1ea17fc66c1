#pragma once

namespace fluidcarve {

class Registry;

/// Registers `ranges`.
void add_energy_payload(Registry& registry);

}  // namespace fluidcarve
