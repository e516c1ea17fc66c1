#pragma once

#include <exception>
#include <string>

namespace fluidcarve {

/// What to tell of an exception that nothing caught: what the system refuses, with a remedy; of all
/// else, that it is a fault of the program. Several lines.
/// @param error  null: no exception of the standard library
std::string breakdown_text(const std::exception* error);

/// Ends the program with exit_code::node_failed and the text of the current exception, in place of
/// a signal: an exception that leaves a thread of a library, or a destructor, ends it by
/// std::terminate. Called before libraries are initialised.
void end_without_signal();

/// Ends the program with a message where a limit of the system is so small that libraries would
/// crash. Called before they are initialised.
void require_room();

/// Makes sure that a number of threads can be started.
/// @throws Failure if the system does not grant them
/// @throws std::bad_alloc
void require_threads(int count);

}  // namespace fluidcarve
