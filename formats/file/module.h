#pragma once

#include <filesystem>
#include <string>

namespace fluidcarve {

/// The symbol `fluidcarve_module` of a module. A module is a shared library with the bodies of
/// nodes that need libraries too slow to load at every start of the program. The core declares
/// these nodes, and opens the module when a pipeline runs one of them.
struct Module {
    const char* version;  ///< FLUIDCARVE_VERSION at build time
    const void* table;    ///< function table: a plain struct declared by a header of the core
};

/// The folder of this library. Files installed with it are found from there.
std::filesystem::path library_folder();

/// The function table of the module `name`. Its file `fluidcarve_NAME.so` lies beside this library.
/// The first call opens it; it stays open. Thread-safe.
/// @param package  the Debian package that the module needs to be built
/// @throws Failure if there is no file (names the path and the package), it can't be opened, or has
///   another version
const void* module_table(const std::string& name, const std::string& package);

/// A folder of files that come with the program: `NAME` beside this library in a build,
/// `share/fluidcarve/NAME` of an installation.
/// @throws Failure naming the paths tried, if there is none
std::string shared_folder(const std::string& name);

template <class Table>
const Table& load_module(const std::string& name) {
    return *static_cast<const Table*>(module_table(name, Table::package));
}

}  // namespace fluidcarve
