#include "runtime/run/outlooks.h"

#include <functional>
#include <utility>

namespace fluidcarve {
namespace {

/// Regions that are known, by node and output.
using Regions = std::map<std::pair<std::size_t, std::size_t>, Region>;

/// What one node knows of its inputs, and states of its outputs.
class OutlookOf : public Outlook {
public:
    OutlookOf(const Node& node, const Regions& known) {
        for (std::size_t i = 0; i < node.inputs.size(); ++i)
            if (!node.inputs[i].empty())
                inputs_[node.type->inputs[i].name] = together(node.inputs[i], known);
    }

    const Region* region(std::string_view input) const override {
        const auto found = inputs_.find(input);
        return found != inputs_.end() && found->second ? &*found->second : nullptr;
    }
    void lies(const Region& region) override { outputs = region; }
    void warn(const std::string& message) override { warnings.push_back(message); }

    /// Says that the outputs lie where all connected inputs lie together, if there are any and all
    /// are known.
    void pass_on() {
        Region all;
        for (const auto& [name, input] : inputs_) {
            if (!input) return;
            all.boxes.insert(all.boxes.end(), input->boxes.begin(), input->boxes.end());
        }
        if (!inputs_.empty()) outputs = std::move(all);
    }

    std::vector<std::string> warnings;
    std::optional<Region> outputs;

private:
    static std::optional<Region> together(const std::vector<Link>& links, const Regions& known) {
        Region out;
        for (const auto& link : links) {
            const auto found = known.find({link.node, link.output});
            if (found == known.end()) return std::nullopt;
            if (links.size() == 1) return found->second;
            out.boxes.insert(out.boxes.end(), found->second.boxes.begin(),
                             found->second.boxes.end());
        }
        return out;
    }

    /// Connected ones; nothing: not known.
    std::map<std::string, std::optional<Region>, std::less<>> inputs_;
};

}  // namespace

void foresee(const Pipeline& pipeline, const Plan& plan, const Inputs& inputs, Report& report) {
    Regions known;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!plan.needed[n]) continue;
        if (const auto told = inputs.regions.find(n);
            told != inputs.regions.end() && !told->second.empty()) {
            for (std::size_t output = 0; output < node.outputs.size(); ++output)
                if (const auto found = told->second.find(node.outputs[output].name);
                    found != told->second.end())
                    known[{n, output}] = found->second;
            continue;
        }
        OutlookOf of(node, known);
        if (node.type->foresee) node.type->foresee(node.params.get(), of);
        else of.pass_on();
        for (const auto& warning : of.warnings) report.warn(n, warning);
        if (!of.outputs) continue;
        for (std::size_t output = 0; output < node.outputs.size(); ++output)
            known[{n, output}] = *of.outputs;
    }
}

}  // namespace fluidcarve
