#pragma once

#include "graph/types/contact_sheet.h"

#include <cstddef>
#include <string>
#include <vector>

namespace fluidcarve {

/// Draws cells in rows, each picture scaled to the width of its column, as one PNG file: whole or not at all.
/// @param columns  cells in a row, at least 1
/// @throws Failure if a picture can't be read, or the file can't be written
void write_contact_sheet(const std::string& title, const std::vector<ContactCell>& cells, std::size_t columns, const std::string& path);

}  // namespace fluidcarve
