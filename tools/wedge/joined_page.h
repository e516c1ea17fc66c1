#pragma once

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The page of one run, to be shown beside those of others.
struct PagePart {
    std::string path;  ///< of the page, as preview.page wrote it
    /// What the run differs in, and its values: {"count", "-4"}.
    std::vector<std::pair<std::string, std::string>> differs;
};

/// Shows several pages in one, for `fluidcarve wedge`: writes it whole or not at all.
/// @param parts  at least one, in the order in which they are shown
/// @throws Failure if a page can't be read or is none of preview.page, or all together are too
///   large
void write_joined_page(const std::string& title, const std::vector<PagePart>& parts,
                       const std::string& path);

}  // namespace fluidcarve
