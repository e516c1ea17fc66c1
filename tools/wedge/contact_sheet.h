#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fluidcarve {

/// A picture of a contact sheet, with what is said of it.
struct ContactCell {
    std::vector<std::string> labels;   ///< lines above the picture
    std::vector<std::string> results;  ///< lines below it
    std::string png;                   ///< path of the picture; empty: there is none
};

/// Draws cells in rows, each picture scaled to the width of its column, as one PNG file: whole or
/// not at all.
/// @param columns  cells in a row, at least 1
/// @throws Failure if a picture can't be read, or the file can't be written
void write_contact_sheet(const std::string& title, const std::vector<ContactCell>& cells,
                         std::size_t columns, const std::string& path);

}  // namespace fluidcarve
