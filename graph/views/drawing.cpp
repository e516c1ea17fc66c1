#include "graph/views/drawing.h"

#include "graph/text/xml_text.h"
#include "graph/views/layout.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {
namespace {

constexpr double margin = 16;
constexpr double legend_height = 22;
constexpr double box_height = 44;
constexpr double note_height = 16;
constexpr const char* ink = "#1d2329";
constexpr const char* line_colour = "#7c8691";  // visible on white and on black

const char* fill(Rate rate) {
    switch (rate) {
        case Rate::fixed: return "#d5dbe1";
        case Rate::sequence: return "#ffd9a0";
        case Rate::frame: break;
    }
    return "#b7d8f7";
}

const char* meaning(Rate rate) {
    switch (rate) {
        case Rate::fixed: return "static: once";
        case Rate::sequence: return "sequence: once, after all frames";
        case Rate::frame: break;
    }
    return "frame: for every frame";
}

/// A connection between two nodes, with its tooltip.
struct Connection {
    std::size_t from = 0;
    std::size_t to = 0;
    std::string text;  ///< "sim.density (float) -> energy.field"
};

std::vector<Connection> connections(const Pipeline& pipeline, const Registry& registry) {
    std::vector<Connection> out;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        for (std::size_t input = 0; input < node.inputs.size(); ++input)
            for (const auto& link : node.inputs[input]) {
                const auto& source = pipeline.nodes[link.node];
                const auto& output = source.outputs[link.output];
                out.push_back(
                    {link.node, n,
                     fmt::format("{}.{} ({}) -> {}.{}", source.name, taken_by(pipeline, link),
                                 registry
                                     .payload(link.part.empty() ? output.type
                                                                : node.type->inputs[input].type)
                                     .name,
                                 node.name, node.type->inputs[input].name)});
            }
    }
    return out;
}

std::string escaped_for_dot(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out;
}

/// Estimated text width in pixels: a little more than in DejaVu Sans, since the viewer may use
/// another font.
double text_width(const std::string& text, double size) {
    return static_cast<double>(text.size()) * size * 0.62;
}

std::string path_of(const std::vector<Layout::Point>& route) {
    std::string out;
    for (std::size_t n = 0; n + 1 < route.size(); n += 2) {
        const auto& [x0, y0] = route[n];
        const auto& [x1, y1] = route[n + 1];
        const double middle = (x0 + x1) / 2;
        out += fmt::format("{}{:.1f},{:.1f} C{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}",
                           n == 0 ? "M" : " L", x0, y0, middle, y0, middle, y1, x1, y1);
    }
    return out;
}

std::string rounded(const Layout::Box& box, const char* colour, double border) {
    return fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" rx="7")"
                       R"( fill="{}" stroke="{}" stroke-width="{}"/>)",
                       box.x, box.y, box.width, box.height, colour, line_colour, border);
}

std::string label(double x, double y, double size, const char* weight, const std::string& text) {
    return fmt::format(
        R"(<text x="{:.1f}" y="{:.1f}" font-size="{}" font-weight="{}" fill="{}">{}</text>)", x, y,
        size, weight, ink, xml_text(text));
}

/// The legend: a row of labels in the colours that they explain.
/// @param right  set to the right end of the row, pixels
std::string legend(const Pipeline& pipeline, double& right) {
    std::string out;
    double x = margin;
    const auto chip = [&](const char* colour, double border, const std::string& text) {
        const double width = text_width(text, 10) + 12;
        out += rounded({width, legend_height, x, margin}, colour, border) +
               label(x + 8, margin + 15, 10, "normal", text) + "\n";
        x += width + 8;
    };
    for (const auto rate : {Rate::fixed, Rate::frame, Rate::sequence})
        if (std::ranges::any_of(pipeline.nodes,
                                [&](const Node& node) { return node.rate == rate; }))
            chip(fill(rate), 1, meaning(rate));
    if (std::ranges::any_of(pipeline.nodes, [](const Node& node) { return node.gathers; }))
        chip("#ffffff", 2.5, "gathers all frames");
    right = x - 8;
    return out;
}

/// @param looks  one per node, or none
Layout laid_out(const Pipeline& pipeline, const std::vector<Connection>& links,
                const std::vector<NodeLook>& looks) {
    const bool plain = looks.empty();
    Layout out;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        const double note = plain ? 0 : text_width(looks[n].note, 11);
        out.boxes.push_back(
            {std::max({text_width(node.name, 13), text_width(node.type->name, 11), note}) + 20,
             box_height + (plain ? 0 : note_height), 0, 0});
    }
    for (const auto& each : links) out.edges.push_back({each.from, each.to, {}});
    out.place();
    return out;
}

/// @param look  null: the node is coloured by rate
std::string node_box(const Node& node, const Layout::Box& box, const NodeLook* look) {
    auto out = fmt::format("<g class=\"node {}\"><title>{}</title>",
                           look ? look->style : to_text(node.rate), xml_text(node.type->doc));
    out += rounded(box, fill(node.rate), node.gathers ? 2.5 : 1);
    out += label(box.x + 10, box.y + 19, 13, "bold", node.name) +
           label(box.x + 10, box.y + 35, 11, "normal", node.type->name);
    if (look) out += label(box.x + 10, box.y + 51, 11, "normal", look->note);
    return out + "</g>\n";
}

/// @param looks  one per node; or none: nodes are then coloured by rate, with a legend
std::string draw(const Pipeline& pipeline, const Registry& registry,
                 const std::vector<NodeLook>& looks) {
    const bool plain = looks.empty();
    const auto links = connections(pipeline, registry);
    const auto layout = laid_out(pipeline, links, looks);
    double right = 0;
    const auto chips = plain ? legend(pipeline, right) : std::string();
    const double top = plain ? 2 * margin + legend_height : margin;
    const double width = std::max(layout.width + 2 * margin, right + margin);
    auto out =
        fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:.0f}" height="{1:.0f}")"
                    R"( viewBox="0 0 {0:.0f} {1:.0f}")"
                    R"( font-family="'DejaVu Sans', Verdana, sans-serif"{2}>)"
                    "\n<title>{3}</title>\n",
                    width, layout.height + top + margin,
                    plain ? std::string() : fmt::format(R"( style="--width:{:.0f}px")", width),
                    xml_text(pipeline.name));
    out += chips;
    out += fmt::format("<g transform=\"translate({},{})\">\n", margin, top);
    for (std::size_t n = 0; n < links.size(); ++n)
        out +=
            fmt::format(R"(<path class="edge" d="{}" fill="none" stroke="{}" stroke-width="1.6">)"
                        R"(<title>{}</title></path>)"
                        "\n",
                        path_of(layout.edges[n].route), line_colour, xml_text(links[n].text));
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        out += node_box(pipeline.nodes[n], layout.boxes[n], plain ? nullptr : &looks[n]);
    return out + "</g>\n</svg>\n";
}

}  // namespace

std::string to_dot(const Pipeline& pipeline, const Registry& registry) {
    auto out = fmt::format(
        "digraph \"{}\" {{\n    rankdir=LR;\n    node [shape=box, style=\"rounded,filled\", "
        "fontname=\"DejaVu Sans\", fontsize=11];\n",
        escaped_for_dot(pipeline.name));
    for (const auto& node : pipeline.nodes)
        out += fmt::format(
            "    \"{}\" [label=\"{}\\n{}\", fillcolor=\"{}\", penwidth={}, tooltip=\"{}\"];\n",
            escaped_for_dot(node.name), escaped_for_dot(node.name),
            escaped_for_dot(node.type->name), fill(node.rate), node.gathers ? 2.5 : 1,
            meaning(node.rate));
    for (const auto& each : connections(pipeline, registry))
        out +=
            fmt::format("    \"{}\" -> \"{}\" [tooltip=\"{}\"];\n",
                        escaped_for_dot(pipeline.nodes[each.from].name),
                        escaped_for_dot(pipeline.nodes[each.to].name), escaped_for_dot(each.text));
    return out + "}\n";
}

std::string to_svg(const Pipeline& pipeline, const Registry& registry) {
    return draw(pipeline, registry, {});
}

std::string to_svg(const Pipeline& pipeline, const Registry& registry,
                   const std::vector<NodeLook>& looks) {
    return draw(pipeline, registry, looks);
}

}  // namespace fluidcarve
