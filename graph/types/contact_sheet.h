#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A picture of a contact sheet, with what is said of it.
struct ContactCell {
    std::vector<std::string> labels;   ///< lines above the picture
    std::vector<std::string> results;  ///< lines below it
    std::string png;                   ///< path of the picture; empty: there is none
};

/// Draws pictures side by side, for `fluidcarve wedge`.
struct ContactSheetWriter {
    /// Writes the sheet as PNG, whole or not at all. @param columns  cells in a row, at least 1
    /// @throws Failure if a picture can't be read, or the sheet can't be written
    std::function<void(const std::string& title, const std::vector<ContactCell>& cells, std::size_t columns, const std::string& path)> write;
};

}  // namespace fluidcarve
