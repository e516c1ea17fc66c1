#include "runtime/run/ports.h"

#include <fmt/format.h>

namespace fluidcarve {

void PortsOf::connect(std::size_t n, void* ports, const Outputs& held, const Outputs* frame) const {
    const auto& node = pipeline.nodes[n];
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
        const auto& spec = node.type->inputs[i];
        std::vector<Payload> in;
        for (const auto& link : node.inputs[i]) {
            const auto& source = pipeline.nodes[link.node];
            const bool per_frame = source.rate == Rate::frame;
            if (per_frame && !frame) continue;
            const auto& payload = (per_frame ? *frame : held)[link.node][link.output];
            if (!payload) throw Failure(fmt::format("input '{}' got nothing from {}.{}", spec.name, source.name, source.outputs[link.output].name));
            in.push_back(taken(link, payload, spec));
        }
        spec.set(ports, in, node.input_names[i]);
    }
}

Payload PortsOf::taken(const Link& link, const Payload& payload, const InputSpec& spec) const {
    if (link.part.empty()) return registry.convert(payload, spec.type);
    try {
        return registry.selection(payload.type(), spec.type)->pick(payload, link.part);
    } catch (const Failure& failure) {
        throw Failure(fmt::format("input '{}': '{}' {}", spec.name, pipeline.nodes[link.node].name, failure.what()), failure.kind);
    }
}

std::vector<Payload> PortsOf::collect(std::size_t n, const void* ports) const {
    std::vector<Payload> out;
    for (const auto& output : pipeline.nodes[n].outputs) out.push_back(output.get(ports));
    return out;
}

std::uint64_t PortsOf::bytes(const std::vector<Payload>& payloads) const {
    std::uint64_t out = 0;
    for (const auto& payload : payloads)
        if (payload) out += registry.payload(payload.type()).bytes(payload);
    return out;
}

}  // namespace fluidcarve
