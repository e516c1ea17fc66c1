#include "runtime/flow/ports.h"

#include <fmt/format.h>

namespace fluidcarve {

void PortIo::connect(std::size_t n, void* ports, const Outputs& held, const Outputs* frame) const {
    const auto& node = pipeline.nodes[n];
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
        const auto& spec = node.type->inputs[i];
        std::vector<Payload> in;
        for (const auto& link : node.inputs[i]) {
            const auto& source = pipeline.nodes[link.node];
            const bool per_frame = source.rate == Rate::frame;
            if (per_frame && !frame) continue;
            const auto& payload = (per_frame ? *frame : held)[link.node][link.output];
            if (!payload)
                throw Failure(fmt::format("input '{}' got nothing from {}.{}", spec.name,
                                          source.name, source.outputs[link.output].name));
            in.push_back(value_of(link, payload, spec));
        }
        spec.set(ports, in, node.input_names[i]);
    }
}

Payload PortIo::value_of(const Link& link, const Payload& payload, const InputSpec& spec) const {
    if (link.part.empty()) return registry.convert(payload, spec.type);
    try {
        return registry.selection(payload.type(), spec.type)->pick(payload, link.part);
    } catch (const Failure& failure) {
        throw Failure(fmt::format("input '{}': '{}' {}", spec.name, pipeline.nodes[link.node].name,
                                  failure.what()),
                      failure.kind);
    }
}

std::set<std::size_t> PortIo::sources(std::size_t n) const {
    std::set<std::size_t> out;
    for (const auto& link : pipeline.nodes[n].links()) out.insert(link.node);
    for (const auto& link : pipeline.nodes[n].checksummed) out.insert(link.node);
    return out;
}

std::vector<std::set<std::size_t>> PortIo::readers() const {
    std::vector<std::set<std::size_t>> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < out.size(); ++n)
        for (const auto source : sources(n)) out[source].insert(n);
    return out;
}

bool PortIo::reads(std::size_t reader, std::size_t n, std::string_view output) const {
    for (const auto& link : pipeline.nodes[reader].links())
        if (link.node == n && pipeline.nodes[n].outputs[link.output].name == output) return true;
    return false;
}

std::vector<Payload> PortIo::collect(std::size_t n, const void* ports) const {
    std::vector<Payload> out;
    for (const auto& output : pipeline.nodes[n].outputs) out.push_back(output.get(ports));
    return out;
}

std::uint64_t PortIo::bytes(const std::vector<Payload>& payloads) const {
    std::uint64_t out = 0;
    for (const auto& payload : payloads)
        if (payload) out += registry.payload(payload.type()).bytes(payload);
    return out;
}

}  // namespace fluidcarve
