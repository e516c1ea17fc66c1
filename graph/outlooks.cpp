#include "graph/outlooks.h"

#include <optional>
#include <string_view>
#include <utility>

namespace fluidcarve {
namespace {

/// Facts about all outputs, by node and output.
struct KnownOutputs {
    std::map<std::pair<std::size_t, std::size_t>, Region> regions;
    std::map<std::size_t, OutputFacts> facts;  ///< by node
};

/// The facts that one node gets about its inputs, and states about its outputs.
class OutlookOf : public Outlook {
public:
    OutlookOf(std::size_t index, const Pipeline& pipeline, const KnownOutputs& known,
              Outlooks& said)
        : index_(index), said_(said) {
        const auto& node = pipeline.nodes[index];
        frames_ = node.input_frames.frames().size();
        once_ = node.rate != Rate::frame && node.input_frames.frames().size() > 1;
        for (std::size_t i = 0; i < node.inputs.size(); ++i) {
            const auto& links = node.inputs[i];
            if (links.empty()) continue;
            Input input{together(links, known), {}};
            for (const auto& link : links) {
                const auto found = known.facts.find(link.node);
                input.facts.push_back(found != known.facts.end() ? found->second : OutputFacts{});
            }
            inputs_[node.type->inputs[i].name] = std::move(input);
        }
    }

    const Region* region(std::string_view input) const override {
        const auto found = inputs_.find(input);
        return found != inputs_.end() && found->second.region ? &*found->second.region : nullptr;
    }
    const std::vector<OutputFacts>& receives(std::string_view input) const override {
        static const std::vector<OutputFacts> none;
        const auto found = inputs_.find(input);
        return found != inputs_.end() ? found->second.facts : none;
    }
    bool once() const override { return once_; }
    std::size_t frames() const override { return frames_; }
    void lies(const Region& region) override { outputs = region; }
    void delivers(const OutputFacts& stated) override { facts = stated; }
    void warn(const std::string& message) override { said_.warnings.push_back({index_, message}); }
    void fault(const std::string& message) override { said_.faults.push_back({index_, message}); }

    /// Sets the outputs' region to the union of all connected inputs' regions, if there are any
    /// and all are known.
    void pass_on() {
        Region all;
        for (const auto& [name, input] : inputs_) {
            if (!input.region) return;
            all.boxes.insert(all.boxes.end(), input.region->boxes.begin(),
                             input.region->boxes.end());
        }
        if (!inputs_.empty()) outputs = std::move(all);
    }

    std::optional<Region> outputs;
    OutputFacts facts;  ///< of the outputs

private:
    struct Input {
        std::optional<Region> region;  ///< nothing: not known
        std::vector<OutputFacts> facts;
    };

    static std::optional<Region> together(const std::vector<Link>& links,
                                          const KnownOutputs& known) {
        Region out;
        for (const auto& link : links) {
            const auto found = known.regions.find({link.node, link.output});
            if (found == known.regions.end()) return std::nullopt;
            if (links.size() == 1) return found->second;
            out.boxes.insert(out.boxes.end(), found->second.boxes.begin(),
                             found->second.boxes.end());
        }
        return out;
    }

    std::size_t index_;
    bool once_ = false;
    std::size_t frames_ = 0;
    Outlooks& said_;
    std::map<std::string, Input, std::less<>> inputs_;  ///< connected ones
};

/// Adds the regions of a node's outputs, which a reader stated by name.
void take_regions(std::size_t n, const Node& node, const auto& read, KnownOutputs& known) {
    for (std::size_t output = 0; output < node.outputs.size(); ++output)
        if (const auto found = read.find(node.outputs[output].name); found != read.end())
            known.regions[{n, output}] = found->second;
}

}  // namespace

Outlooks foresee(const Pipeline& pipeline, const std::vector<bool>& needed,
                 const ReadRegions& read) {
    Outlooks out;
    KnownOutputs known;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!needed[n]) continue;
        if (const auto told = read.find(n); told != read.end() && !told->second.empty()) {
            take_regions(n, node, told->second, known);
            continue;
        }
        OutlookOf of(n, pipeline, known, out);
        if (node.type->foresee) node.type->foresee(node.params.get(), of);
        if (!of.outputs) of.pass_on();
        known.facts[n] = std::move(of.facts);
        if (!of.outputs) continue;
        for (std::size_t output = 0; output < node.outputs.size(); ++output)
            known.regions[{n, output}] = *of.outputs;
    }
    return out;
}

}  // namespace fluidcarve
