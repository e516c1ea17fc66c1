#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fluidcarve {

/// The only folders in which pipelines may read and write: `--confine`.
class Confinement {
public:
    /// No folders: everything is allowed.
    Confinement() = default;
    /// @throws Failure if one is not a folder
    explicit Confinement(const std::vector<std::string>& folders);

    bool on() const { return !folders_.empty(); }
    /// Why a file may not be opened, and the remedy, as words that follow its path: "leads to
    /// ..."; empty if it may. Follows all links, also dangling ones.
    std::string refusal(const std::string& path) const;
    /// The same for an open file, by its present place. @param descriptor  of the file
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
