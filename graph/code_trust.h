#pragma once

namespace fluidcarve {

/// Whether pipelines may name code that runs with the user's rights, such as Python scripts
/// (`--allow-plugins`). Initially false.
bool code_allowed();
/// Allows such code until the program ends. Call it once, before other threads start.
void allow_code();

}  // namespace fluidcarve
