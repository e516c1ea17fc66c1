#pragma once

#include <exception>
#include <string>

namespace fluidcarve {

/// The message for an uncaught exception: if the system refused something, that and a remedy; else
/// that it is a fault of the program. Several lines.
/// @param error  null: no exception of the standard library
std::string uncaught_text(const std::exception* error);

/// Makes std::terminate end the program with exit_code::node_failed and the text of the current
/// exception, in place of a signal. Exceptions that leave a library's thread, or a destructor,
/// lead there. Call it before libraries are initialised.
void end_without_signal();

/// Ends the program with a message if a limit of the system is so small that libraries would
/// crash. Call it before they are initialised.
void require_address_space();

/// Makes sure that a number of threads can be started.
/// @throws Failure if the system does not grant them
/// @throws std::bad_alloc
void require_threads(int count);

}  // namespace fluidcarve
