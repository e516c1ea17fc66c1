#pragma once

#include <string>

namespace fluidcarve {

/// Whether stderr is a terminal and the environment variable NO_COLOR is not set.
bool coloured_terminal();

/// Prints a line to stderr. On a coloured terminal, a first word `failed:`, `warning:` or `done:`
/// is highlighted.
void tell(const std::string& text);

/// From now on, tell() prints each text as a line of JSON, for programs (pipelines/FORMATS.md
/// "Events").
void tell_as_events();
/// Whether tell_as_events() was called.
bool told_as_events();
/// Prints an event.
/// @param otherwise  its kind, unless the text begins with `failed:`, `warning:` or `done:`
void tell_event(const std::string& text, const std::string& otherwise);

}  // namespace fluidcarve
