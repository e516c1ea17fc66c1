#include "runtime/run/conclusions.h"

#include <fmt/format.h>

namespace fluidcarve {
namespace {

/// The Context::Host of a node that concludes.
struct Concluding : Context::Host {
    Concluding(Report& to, std::size_t node) : to(to), node(node) {}
    Report& to;
    const std::size_t node;
    void warn(const std::string& message) override { to.warn(node, message); }
    void report(const std::string& section, const nlohmann::ordered_json& entry) override {
        to.entry(node, section, entry);
    }
    void tell(const std::string& line) override { to.add_line(node, line); }
};

}  // namespace

void conclude(const Pipeline& pipeline, const Timelines& timelines,
              const std::vector<NodeDemand>& demands, Report& report) {
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!node.type->conclude) continue;
        // Entries are missing if frames failed, or if results were kept by a version that did not
        // report.
        const auto known = report.entry_of(n, node.type->concludes_from);
        if (known.empty() || known.size() != demands[n].needed) continue;
        Concluding host(report, n);
        Context context(host, timelines.delivered(n).frames);
        try {
            node.type->conclude(node.params.get(), known, context);
        } catch (const std::exception& error) {
            report.warn(n, fmt::format("can't say what came of its frames: {}", error.what()));
        }
    }
}

}  // namespace fluidcarve
