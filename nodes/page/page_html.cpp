#include "nodes/page/page_html.h"

#include "carve/base/failure.h"
#include "graph/text/json_text.h"
#include "graph/text/xml_text.h"
#include "nodes/page/page_texts.h"
#include "nodes/preview/shown_frames.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

namespace fluidcarve {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t usual_bytes = 2 << 20, most_bytes = 20 << 20;
constexpr std::string_view data_begin = "<script type=\"application/json\" id=\"data\">",
                           data_end = "</script>";

/// Replaces the first `{{name}}` of a text.
void fill(std::string& text, std::string_view name, std::string_view by) {
    const auto mark = fmt::format("{{{{{}}}}}", name);
    text.replace(text.find(mark), mark.size(), by);
}

std::string in_megabytes(std::size_t bytes) {
    return fmt::format("{:.1f} MB", static_cast<double>(bytes) / (1 << 20));
}

/// Visits all packed() texts of a scene.
template <class Visit>
void each_packed(Json& scene, const Visit& visit) {
    for (auto& frame : scene.at("frames")) visit(frame.at("voxels"));
    for (auto& lattice : scene.at("lattices")) visit(lattice.at("planes"));
    for (auto& seams : scene.at("seams")) visit(seams);
}

/// The same scene with fewer frames, and without data that only the other frames need.
Json with_frames(const Json& scene, int count) {
    auto out = scene;
    auto frames = Json::array();
    const auto& all = scene.at("frames");
    for (std::size_t n = 0; n < all.size(); ++n)
        if (is_shown(n, all.size(), count)) frames.push_back(all[n]);
    for (const auto& [name, list] :
         {std::pair("lattice", "lattices"), {"rig", "rigs"}, {"seams", "seams"}}) {
        std::map<std::size_t, std::size_t> numbers;
        auto used = Json::array();
        const auto renumber = [&, list = list](Json& number) {
            const auto [place, fresh] = numbers.emplace(number.get<std::size_t>(), used.size());
            if (fresh) used.push_back(scene.at(list).at(place->first));
            number = place->second;
        };
        for (auto& frame : frames) {
            auto& of = frame.at(name);
            if (of.is_array()) std::for_each(of.begin(), of.end(), renumber);
            else if (!of.is_null()) renumber(of);
        }
        out[list] = std::move(used);
    }
    out["frames"] = std::move(frames);
    return out;
}

}  // namespace

std::string page_html(const std::string& title, std::vector<Json> scenes) {
    auto texts = Json::array();
    std::map<std::string, std::size_t> numbers;
    for (auto& scene : scenes)
        each_packed(scene, [&](Json& text) {
            const auto [place, fresh] = numbers.emplace(text.get<std::string>(), texts.size());
            if (fresh) texts.push_back(std::move(text));
            text = place->second;
        });
    auto data = json_text(
        Json{{"title", title}, {"packed", std::move(texts)}, {"scenes", std::move(scenes)}});
    // Nothing in a text may end the element that holds the data.
    for (auto at = data.find('<'); at != std::string::npos; at = data.find('<', at))
        data.replace(at, 1, "\\u003c");
    const auto& files = page_texts();
    std::string out(files.at("page.html"));
    fill(out, "title", xml_text(title));
    fill(out, "style", files.at("page.css"));
    for (const auto* const script :
         {"lattice", "carve", "scene", "volume", "picture", "view", "page"})
        fill(out, script, files.at(std::string(script) + ".js"));
    fill(out, "data", data);
    return out;
}

SmallPage small_page(const std::string& title, const std::vector<Json>& scenes) {
    std::size_t most = 0;
    for (const auto& scene : scenes) most = std::max(most, scene.at("frames").size());
    SmallPage out{page_html(title, scenes), most};
    while (out.html.size() > usual_bytes && out.frames > 1) {
        --out.frames;
        auto fewer = scenes;
        for (auto& scene : fewer) scene = with_frames(scene, static_cast<int>(out.frames));
        out.html = page_html(title, std::move(fewer));
    }
    return out;
}

void require_page_size(const std::string& html, const std::string& remedy) {
    if (html.size() > most_bytes)
        throw Failure(fmt::format("the page would have {}, more than {}; {}",
                                  in_megabytes(html.size()), in_megabytes(most_bytes), remedy));
}

std::vector<Json> scenes_of_page(const std::string& html) {
    const auto fault = [] { return Failure("it is no page that preview.page wrote"); };
    const auto begin = html.find(data_begin);
    if (begin == std::string::npos) throw fault();
    const auto from = begin + data_begin.size(), to = html.find(data_end, from);
    if (to == std::string::npos) throw fault();
    try {
        auto data = Json::parse(html.begin() + static_cast<std::ptrdiff_t>(from),
                                html.begin() + static_cast<std::ptrdiff_t>(to));
        std::vector<Json> out = data.at("scenes");
        for (auto& scene : out)
            each_packed(scene,
                        [&](Json& text) { text = data.at("packed").at(text.get<std::size_t>()); });
        return out;
    } catch (const Json::exception&) {
        throw fault();
    }
}

}  // namespace fluidcarve
