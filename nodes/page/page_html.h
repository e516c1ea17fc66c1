#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace fluidcarve {

/// A page as one HTML file that loads nothing else. Scenes stand side by side, with controls for
/// all; equal packed data is written once.
/// @param scenes  page_scene() of each, at least one; `differs`, if present, lists the differences
///   of a scene as `[target, value]`
std::string page_html(const std::string& title, std::vector<nlohmann::ordered_json> scenes);

/// A page with fewer frames than there were, to stay small.
struct SmallPage {
    std::string html;
    std::size_t frames = 0;  ///< of the scene with the most frames
};

/// A page of at most 2 MB: of each scene as many frames as fit, in even steps, at least one.
SmallPage small_page(const std::string& title, const std::vector<nlohmann::ordered_json>& scenes);

/// Refuses a page above 20 MB. @param remedy  how to make it smaller
/// @throws Failure with its size and the remedy
void require_page_size(const std::string& html, const std::string& remedy);

/// The scenes of a page, as page_html() took them.
/// @throws Failure if the text is not such a page
std::vector<nlohmann::ordered_json> scenes_of_page(const std::string& html);

}  // namespace fluidcarve
