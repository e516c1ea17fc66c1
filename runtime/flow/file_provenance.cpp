#include "runtime/flow/file_provenance.h"

#include <fmt/format.h>

namespace fluidcarve {

Provenance FileProvenance::of(std::size_t writer) {
    const auto& node = pipeline_.nodes[writer];
    std::string all;
    const std::lock_guard lock(mutex_);
    for (const auto& link : node.checksummed) {
        const auto [found, fresh] = checksums_.try_emplace({link.node, link.output});
        const auto& payload = held_[link.node].at(link.output);
        if (fresh) found->second = registry_.payload(payload.type()).checksum(payload);
        all += fmt::format("{}{}={}", all.empty() ? "" : ", ", pipeline_.nodes[link.node].name,
                           found->second);
    }
    auto out = node.provenance;
    // The command comes last.
    if (!all.empty()) out.insert(out.end() - 1, {"fluidcarve_seams", all});
    return out;
}

}  // namespace fluidcarve
