#include "runtime/html/html_report.h"

#include "carve/base/frame_set.h"
#include "carve/base/words.h"
#include "formats/file/input_file.h"
#include "graph/text/xml_text.h"
#include "graph/views/drawing.h"
#include "runtime/html/grid_rows.h"
#include "runtime/html/html_parts.h"
#include "runtime/html/html_words.h"
#include "runtime/html/seams_html.h"
#include "runtime/tell/exit_codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace fluidcarve {

namespace {

using Json = nlohmann::ordered_json;

/// Builds the page, section by section.
class Page {
public:
    explicit Page(const RunShown& run) : run_(run) {
        for (const auto& [name, node] : run.report.at("nodes").items())
            all_s_ += node.at("wall_s").get<double>();
        for (const auto& failure : run.report.at("failures"))
            failed_.insert(failure.at("node").get<std::string>());
    }

    std::string text() {
        head();
        failures();
        warnings();
        pictures();
        graph();
        nodes();
        for (const auto& [name, entry] : run_.report.at("seams").items()) seams(name, entry);
        grids();
        for (const auto& [name, section] : run_.report.items())
            if (name != "nodes" && name != "seams" && name != "grids" && name != "grids_by_frame" &&
                section.is_object() && !section.empty())
                others(name, section);
        values();
        return out_ + "</body>\n</html>\n";
    }

private:
    const Json* measured(const std::string& node) const {
        const auto found = run_.report.at("nodes").find(node);
        return found == run_.report.at("nodes").end() ? nullptr : &*found;
    }
    static std::size_t count(const Json& node, const char* field) {
        return node.at(field).get<std::size_t>();
    }
    static bool all_kept(const Json& node) {
        return count(node, "frames") > 0 && count(node, "cached") == count(node, "frames");
    }
    void section(const std::string& title) { out_ += element("h2", title) + "\n"; }

    std::string outcome() const {
        const auto frames = counted(run_.report.at("frames").size(), "frame");
        const auto time = duration_text(run_.report.at("wall_s").get<double>());
        switch (run_.report.at("exit").get<int>()) {
            case exit_code::done: return fmt::format("Done: {} in {}", frames, time);
            case exit_code::some_frames_failed:
                return fmt::format("Done in {}, but some frames failed", time);
            case exit_code::input: return "Not run: an input is missing, unreadable or too large";
            case exit_code::interrupted: return fmt::format("Interrupted after {}", time);
            default: return fmt::format("Failed after {}", time);
        }
    }

    void head() {
        out_ = page_begin(run_.pipeline.name);
        out_ += element("p class=\"eyebrow\"",
                        fmt::format("fluidcarve {}, {}",
                                    run_.report.at("fluidcarve").get<std::string>(), run_.when)) +
                "\n";
        out_ += element("h1", run_.pipeline.name) + "\n";
        out_ += element(run_.report.at("exit") == exit_code::done ? "p class=\"outcome\""
                                                                  : "p class=\"outcome bad\"",
                        outcome()) +
                "\n<dl class=\"facts\">\n";
        const auto add = [&](const std::string& name, const std::string& value) {
            out_ += "<div>" + element("dt", name) + element("dd", value) + "</div>\n";
        };
        const auto frames = run_.report.at("frames").get<std::vector<int>>();
        if (!frames.empty())
            add("Frames", frames.size() == 1
                              ? FrameSet(frames).text()
                              : fmt::format("{} ({})", FrameSet(frames).text(), frames.size()));
        std::size_t results = 0, kept = 0;
        for (const auto& [name, node] : run_.report.at("nodes").items()) {
            results += count(node, "frames");
            kept += count(node, "cached");
        }
        if (results > 0) add("From earlier runs", fmt::format("{} of {} results", kept, results));
        for (const auto& [name, entry] : run_.report.at("seams").items()) {
            const bool inserts = word(entry, "kind") == "insert";
            add(run_.report.at("seams").size() == 1 ? "Seams" : "Seams of " + name,
                fmt::format("{} {}", numbers(entry, "energy").size(),
                            inserts ? "inserted" : "removed"));
        }
        add("Time", duration_text(run_.report.at("wall_s").get<double>()));
        add("Peak memory", size_text(run_.report.at("peak_rss_bytes").get<std::uint64_t>()));
        out_ += "</dl>\n";
    }

    void failures() {
        const auto& failures = run_.report.at("failures");
        if (failures.empty()) return;
        section("Failures");
        std::vector<int> frames;
        for (const auto& failure : failures)
            if (failure.contains("frame")) frames.push_back(failure.at("frame").get<int>());
        if (!frames.empty()) {
            const FrameSet failed(frames);
            out_ += element("p", fmt::format("Failed {}: {}",
                                             failed.frames().size() == 1 ? "frame" : "frames",
                                             failed.text())) +
                    "\n";
        }
        out_ += "<ul class=\"messages failures\">\n";
        for (const auto& failure : failures) {
            const auto place = failure.contains("frame")
                                   ? fmt::format(", frame {}", failure.at("frame").get<int>())
                                   : std::string();
            message(failure, place);
        }
        out_ += "</ul>\n";
    }

    void warnings() {
        if (run_.report.at("warnings").empty()) return;
        section("Warnings");
        out_ += "<ul class=\"messages\">\n";
        for (const auto& warning : run_.report.at("warnings")) message(warning, "");
        out_ += "</ul>\n";
    }

    void message(const Json& entry, const std::string& place) {
        const auto name = entry.at("node").get<std::string>();
        const auto* const node = run_.pipeline.find(name);
        out_ += "<li>" +
                element("small",
                        fmt::format("{}{}{}", name,
                                    node ? fmt::format(" ({})", node->type->name) : "", place)) +
                xml_text(entry.at("message").get<std::string>()) + "</li>\n";
    }

    void pictures() {
        section("Pictures");
        if (run_.files.pictures.empty())
            out_ +=
                "<p class=\"muted\">No node of this pipeline writes a picture. A "
                "<code>preview.sheet</code> node draws before and after, side by side, to a "
                "PNG file, which is then shown here.</p>\n";
        for (const auto& picture : run_.files.pictures) {
            const auto caption = fmt::format("{}, written by {}", picture.path, picture.node);
            if (!picture.fault.empty()) {
                out_ += element("p class=\"muted\"",
                                fmt::format("{} writes {}, which {}.", picture.node, picture.path,
                                            picture.fault)) +
                        "\n";
                continue;
            }
            out_ += picture_figure(caption + (picture.earlier ? " in an earlier run" : ""),
                                   picture.png);
        }
        for (const auto& page : run_.files.pages)
            out_ += fmt::format(
                "<p>Before and after, with a slider for the count: <a href=\"{}\">{}</a>, written "
                "by {}</p>\n",
                xml_text(page.address), xml_text(page.path), xml_text(page.node));
    }

    static constexpr std::array<double, 5> heats{
        0, 0.02, 0.1, 0.25, 0.5};  ///< least share of the total time (0..1) for each heat colour

    NodeLook look(const Node& node) const {
        const auto* const entry = measured(node.name);
        NodeLook out{"idle", "not in this run"};
        if (entry && all_kept(*entry)) {
            out = {"kept", "from earlier runs"};
        } else if (entry) {
            const auto seconds = entry->at("wall_s").get<double>();
            const double share = all_s_ > 0 ? seconds / all_s_ : 0;
            const auto heat = std::ranges::upper_bound(heats, share) - heats.begin() - 1;
            out = {fmt::format("heat{}", std::max<std::ptrdiff_t>(0, heat)),
                   fmt::format("{}, {:.0f} %", duration_text(seconds), share * 100)};
        }
        if (failed_.contains(node.name)) out = {out.style + " failed", "failed"};
        return out;
    }

    void graph() {
        section("Graph");
        std::vector<NodeLook> looks;
        for (const auto& node : run_.pipeline.nodes) looks.push_back(look(node));
        out_ += "<div class=\"graph\"><div class=\"scroll\">\n" +
                (looks.empty() ? std::string() : to_svg(run_.pipeline, run_.registry, looks)) +
                "</div>\n<ul class=\"legend\">\n";
        const auto chip = [&](const std::string& style, const std::string& meaning) {
            const bool shown = std::ranges::any_of(looks, [&](const NodeLook& look) {
                return (look.style + " ").find(style + " ") != std::string::npos;
            });
            if (shown) out_ += fmt::format("<li><i class=\"{}\"></i>{}</li>\n", style, meaning);
        };
        for (std::size_t n = 0; n < heats.size(); ++n) {
            const auto low = fmt::format("{:.0f}", heats[n] * 100),
                       high = n + 1 < heats.size() ? fmt::format("{:.0f}", heats[n + 1] * 100)
                                                   : std::string();
            chip(fmt::format("heat{}", n), n == 0 ? fmt::format("under {} % of the time", high)
                                           : high.empty() ? fmt::format("over {} %", low)
                                                          : fmt::format("{} to {} %", low, high));
        }
        chip("kept", "from earlier runs");
        chip("idle", "not in this run");
        chip("failed", "failed");
        if (std::ranges::any_of(run_.pipeline.nodes, [](const Node& node) { return node.gathers; }))
            out_ += "<li><i class=\"gathers\"></i>heavy border: gathers all frames</li>\n";
        out_ += "</ul></div>\n";
    }

    void nodes() {
        if (run_.report.at("nodes").empty()) return;
        section("Nodes");
        out_ +=
            "<p class=\"muted\">Time is the sum over all frames and threads. Memory is the largest "
            "result of a frame, files are what the node has written.</p>\n"
            "<div class=\"scroll\"><table class=\"wide\"><thead><tr><th>node</th><th "
            "class=\"number\">frames</th><th class=\"number\">from earlier runs</th><th "
            "class=\"number\">time</th><th></th><th class=\"number\">a frame</th><th "
            "class=\"number\">memory</th><th class=\"number\">files</th></tr></thead><tbody>\n";
        double most = 0;
        for (const auto& [name, node] : run_.report.at("nodes").items())
            most = std::max(most, node.at("wall_s").get<double>());
        for (const auto& [name, node] : run_.report.at("nodes").items()) {
            const auto seconds = node.at("wall_s").get<double>();
            const auto computed = count(node, "frames") - count(node, "cached");
            const auto bytes = node.at("bytes").get<std::uint64_t>();
            const auto written = run_.files.bytes.find(name);
            const auto cell = [&](const std::string& text) {
                out_ += element("td class=\"number\"", text);
            };
            out_ +=
                fmt::format("<tr><th><a href=\"#node-{}\">{}</a>{}</th>", xml_text(name),
                            xml_text(name), element("small", node.at("type").get<std::string>()));
            cell(std::to_string(count(node, "frames")));
            cell(count(node, "cached") > 0 ? std::to_string(count(node, "cached")) : "");
            cell(all_kept(node) ? "" : duration_text(seconds));
            out_ +=
                all_kept(node) || most <= 0
                    ? "<td></td>"
                    : fmt::format(
                          "<td><span class=\"meter\"><i style=\"width:{:.1f}%\"></i></span></td>",
                          100 * seconds / most);
            cell(computed > 0 ? duration_text(seconds / static_cast<double>(computed)) : "");
            cell(bytes > 0 ? size_text(bytes) : "");
            cell(written != run_.files.bytes.end() ? size_text(written->second) : "");
            out_ += "</tr>\n";
        }
        out_ += "</tbody></table></div>\n";
    }

    void seams(const std::string& name, const Json& entry) {
        section(run_.report.at("seams").size() == 1 ? "Seams" : "Seams of " + name);
        out_ += seams_html(entry);
    }

    void grids() {
        const auto found = run_.report.find("grids");
        if (found == run_.report.end()) return;
        section("Carved grids");
        out_ += element("p class=\"muted\"",
                        "In world units. Mass is the mean of all frames; flicker is its mean "
                        "change from frame to frame, as a share.") +
                "\n" + wide_table(grid_heads, grid_rows(*found));
    }

    /// Any other section of the report, with entries per node or per node and frame.
    void others(const std::string& name, const Json& entries) {
        auto title = words(name);
        title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
        section(title);
        std::vector<std::string> fields;
        std::vector<std::pair<std::string, const Json*>> found;
        for (const auto& [node, entry] : entries.items()) {
            const auto is_object = [](const Json& each) { return each.is_object(); };
            if (entry.is_object() && !entry.empty() && std::ranges::all_of(entry, is_object))
                for (const auto& [frame, each] : entry.items())
                    found.emplace_back(
                        frame == "all" ? node : fmt::format("{}, frame {}", node, frame), &each);
            else found.emplace_back(node, &entry);
        }
        for (const auto& [row, entry] : found)
            if (entry->is_object())
                for (const auto& [field, value] : entry->items())
                    if (std::ranges::find(fields, field) == fields.end()) fields.push_back(field);
        std::vector<std::string> heads{"node"};
        for (const auto& field : fields) heads.push_back(words(field));
        if (fields.empty()) heads.emplace_back("value");
        std::vector<std::vector<std::string>> rows;
        for (const auto& [row, entry] : found) {
            rows.push_back({row});
            if (!entry->is_object()) rows.back().push_back(plain(*entry));
            else
                for (const auto& field : fields)
                    rows.back().push_back(entry->contains(field) ? plain(entry->at(field)) : "");
        }
        out_ += wide_table(heads, rows);
    }

    void values() {
        section("Pipeline");
        out_ += "<p class=\"muted\">Every value, and where it comes from.</p>\n";
        std::vector<std::pair<std::string, const ValueSource*>> rows{
            {"frames", &run_.sources.frames}};
        for (const auto& [name, source] : run_.sources.params) rows.emplace_back(name, &source);
        out_ += (run_.sources.params.empty() ? element("h3", "Frames")
                                             : element("h3", "Frames and params")) +
                "\n" + values_table(rows);
        for (const auto& [name, fields] : run_.sources.nodes) {
            std::vector<std::pair<std::string, const ValueSource*>> stated, defaults;
            for (const auto& [field, source] : fields)
                (source.from == "default" ? defaults : stated).emplace_back(field, &source);
            out_ += fmt::format("<h3 id=\"node-{}\">{}</h3>\n", xml_text(name), xml_text(name));
            out_ += values_table(stated);
            if (!defaults.empty())
                out_ += "<details>" + element("summary", counted(defaults.size(), "default")) +
                        "\n" + values_table(defaults) + "</details>\n";
        }
    }

    const RunShown& run_;
    double all_s_ = 0;              ///< time of all nodes, seconds
    std::set<std::string> failed_;  ///< names of failed nodes
    std::string out_;
};

}  // namespace

std::string to_html(const RunShown& run) { return Page(run).text(); }

}  // namespace fluidcarve
