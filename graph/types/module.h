#pragma once

#include <string>

namespace fluidcarve {

/// What a module's library exports under the name `fluidcarve_module`: bodies of nodes whose libraries are too heavy for every
/// start of the program. Declarations stay in the core, which opens a module when a pipeline runs one of its nodes.
struct Module {
    const char* version;  ///< FLUIDCARVE_VERSION of its build
    const void* table;    ///< its functions, a plain struct that the family's header declares
};

/// The table of the module `name`: `fluidcarve_NAME.so` beside this library or the program, or in `../lib/fluidcarve` of it.
/// Opened by the first call, once, from whatever thread; it stays open.
/// @throws Failure saying where it was looked for, if there is none; if it can't be opened, or is of another version
const void* module_table(const std::string& name);

template <class Table>
const Table& load_module(const std::string& name) {
    return *static_cast<const Table*>(module_table(name));
}

}  // namespace fluidcarve
