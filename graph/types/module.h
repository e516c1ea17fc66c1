#pragma once

#include <string>

namespace fluidcarve {

/// The symbol `fluidcarve_module` of a module. A module is a shared library with the bodies of nodes that need libraries too slow
/// to load at every start of the program. The core declares these nodes, and opens the module when a pipeline runs one of them.
struct Module {
    const char* version;  ///< FLUIDCARVE_VERSION at build time
    const void* table;    ///< function table: a plain struct declared by a header of the core
};

/// The function table of the module `name`. Its file `fluidcarve_NAME.so` is in the folder of this library or of the program, or in
/// `../lib/fluidcarve` of such a folder. The first call opens it; it stays open. Thread-safe.
/// @throws Failure if there is no file (names the paths tried), it can't be opened, or has another version
const void* module_table(const std::string& name);

/// A folder of files that come with the program: `NAME` beside this library or the program, or `../share/fluidcarve/NAME` of such a folder.
/// @throws Failure naming the paths tried, if there is none
std::string shared_folder(const std::string& name);

template <class Table>
const Table& load_module(const std::string& name) {
    return *static_cast<const Table*>(module_table(name));
}

}  // namespace fluidcarve
