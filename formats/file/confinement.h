#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fluidcarve {

/// Folders outside of which no pipeline makes the program read or write: `--confine`.
class Confinement {
public:
    /// No folders: everything is allowed.
    Confinement() = default;
    /// @throws Failure if one is no folder
    explicit Confinement(const std::vector<std::string>& folders);

    bool on() const { return !folders_.empty(); }
    /// Why a file may not be opened, and the remedy, as words that follow its path: "leads to ...";
    /// empty if it may. Follows all links, also those that lead to nothing yet.
    std::string refusal(const std::string& path) const;
    /// The same of a file that is open: where it lies now. @param descriptor  of the system
    std::string refusal_of_open(int descriptor) const;

    /// The confinement of this program.
    static const Confinement& of_program() { return program(); }
    /// Confines this program until its end. To be called once, before other threads start.
    /// @throws Failure as the constructor
    static void confine_program(const std::vector<std::string>& folders) {
        program() = Confinement(folders);
    }

private:
    static Confinement& program();
    std::vector<std::filesystem::path> folders_;  ///< absolute, without links
};

}  // namespace fluidcarve
