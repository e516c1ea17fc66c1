#include "graph/text/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

std::string text_table(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths(rows.front().size(), 0);
    for (const auto& row : rows)
        for (std::size_t n = 0; n < row.size(); ++n) widths[n] = std::max(widths[n], row[n].size());
    std::string out;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t n = 0; n < row.size(); ++n) {
            const bool left = n < 2 || n + 1 == row.size();
            line += left ? fmt::format("{:<{}}  ", row[n], widths[n])
                         : fmt::format("{:>{}}  ", row[n], widths[n]);
        }
        out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return out;
}

}  // namespace fluidcarve
