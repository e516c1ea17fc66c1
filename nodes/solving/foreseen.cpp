#include "nodes/solving/foreseen.h"

#include "nodes/params/carve_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace fluidcarve {

namespace {

/// The fault of the placement; empty: none.
/// @param energy   region of the voxels in the files that the energy is made of
/// @param lattice  null: not known
std::string placement_fault(const Region& energy, const Region* lattice) {
    if (energy.boxes.empty())
        return "by their headers, the files that `energy` comes from have no active voxels in any "
               "frame: there is nothing to carve; choose another grid under `grids` of their "
               "reader, `fluidcarve inspect` lists them";
    if (!lattice || lattice->boxes.empty() || meet(energy.boxes, lattice->boxes)) return {};
    const auto better = std::ranges::find_if(
        lattice->otherwise,
        [&](const Region::Otherwise& other) { return meet(energy.boxes, other.boxes); });
    return fmt::format(
        "the lattice misses the data: it lies within {}, but the files that `energy` comes from "
        "have voxels, by their headers, only from {}; {}",
        to_text(around(lattice->boxes)), to_text(around(energy.boxes)),
        better != lattice->otherwise.end() ? fmt::format("with {} they meet", better->how)
                                           : "move the lattice (its rig, or `min` and `max`) or "
                                             "the data (`translate` and `scale` of its reader)");
}

}  // namespace

void warn_of_placement(Outlook& ahead) {
    const auto* const energy = ahead.region("energy");
    if (!energy) return;
    if (const auto fault = placement_fault(*energy, ahead.region("lattice")); !fault.empty())
        ahead.warn(fault);
}

namespace {

constexpr std::array axis_facts{"u", "v", "w"};
constexpr auto closed_fact = "closed", around_fact = "around", warp_fact = "warp",
               moves_fact = "moves";

int value_of(const OutputFacts& facts, const char* name) {
    const auto found = facts.find(name);
    return found == facts.end() ? 0 : found->second;
}

}  // namespace

void deliver_form(const LatticeForm& form, Outlook& ahead) {
    OutputFacts out{{closed_fact, form.closed}, {around_fact, form.around}};
    for (std::size_t n = 0; n < 3; ++n) out[axis_facts[n]] = form.shape[n];
    ahead.delivers(out);
}

LatticeForm received_form(const Outlook& ahead) {
    LatticeForm out;
    const auto& received = ahead.receives("lattice");
    if (received.empty()) return out;
    for (std::size_t n = 0; n < 3; ++n) out.shape[n] = value_of(received.front(), axis_facts[n]);
    out.closed = value_of(received.front(), closed_fact) != 0;
    out.around = value_of(received.front(), around_fact) != 0;
    return out;
}

void deliver_warp(bool still, Outlook& ahead) {
    ahead.delivers({{warp_fact, 1}, {moves_fact, still ? 0 : 1}});
}

bool receives_warp(const Outlook& ahead) {
    return std::ranges::any_of(ahead.receives("seams"), [](const OutputFacts& facts) {
        return value_of(facts, warp_fact) != 0;
    });
}

void foresee_part(const Auto<Count>& count, Outlook& ahead) {
    const auto& received = ahead.receives("seams");
    if (count && count->value != 0 && !received.empty() &&
        value_of(received.back(), warp_fact) != 0)
        ahead.fault(part_of_warp);
}

void foresee_carve(const Auto<Count>& count, Outlook& ahead) {
    foresee_part(count, ahead);
    const bool moves = std::ranges::any_of(ahead.receives("seams"), [](const OutputFacts& facts) {
        return value_of(facts, moves_fact) != 0;
    });
    if (moves && ahead.once())
        ahead.fault(
            "carves the source once for all frames, but the warp changes from frame to frame; set "
            "`static: true` at the warp, or read the source by a path with a frame token");
}

}  // namespace fluidcarve
