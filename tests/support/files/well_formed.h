#pragma once

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <vector>

/// Whether all elements of XML or HTML are closed in order, all attributes are quoted and no stray
/// < or & is left.
inline bool well_formed(std::string_view xml) {
    std::vector<std::string_view> open;
    for (auto at = xml.find_first_of("<&"); at != xml.npos; at = xml.find_first_of("<&", at + 1)) {
        const auto rest = xml.substr(at + 1);
        if (xml[at] == '&') {
            const auto names = {"lt;", "gt;", "amp;", "quot;"};
            if (std::ranges::none_of(names,
                                     [&](const char* name) { return rest.starts_with(name); }))
                return false;
            continue;
        }
        const auto end = rest.find_first_of("<>");
        if (end == rest.npos || rest[end] == '<') return false;
        const auto tag = rest.substr(0, end);
        const auto name = tag.substr(0, tag.find(' '));
        const auto alone = {"!DOCTYPE", "meta", "img", "input"};
        if (std::ranges::count(tag, '"') % 2 != 0) return false;
        if (tag.starts_with('/')) {
            if (open.empty() || open.back() != tag.substr(1)) return false;
            open.pop_back();
        } else if (!tag.ends_with('/') && std::ranges::find(alone, name) == alone.end()) {
            open.push_back(name);
        }
    }
    return open.empty();
}
