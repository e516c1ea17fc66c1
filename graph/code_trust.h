#pragma once

namespace fluidcarve {

/// Whether pipelines may name code that runs with the user's rights, such as scripts of Python:
/// `--allow-plugins`. At first they may not.
bool code_allowed();
/// Allows it until the program's end. To be called once, before other threads start.
void allow_code();

}  // namespace fluidcarve
