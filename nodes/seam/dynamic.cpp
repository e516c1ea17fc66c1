#include "nodes/seam/dynamic.h"

#include "graph/text/problem.h"
#include "nodes/seam/cut/cut_seam.h"
#include "nodes/seam/declare_solver.h"
#include "nodes/seam/search/columns.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

namespace {

bool in_line(const Columns& columns) { return std::max({columns.laterals(), columns.slices(), columns.frames()}) == columns.count(); }

bool closes(const Columns& columns) { return columns.ring(0) || columns.ring(1); }

}  // namespace

bool in_open_line(const EnergyVolume& energy) {
    const Columns columns(energy);
    return in_line(columns) && !closes(columns);
}

Seams::Seam dynamic_seam(const EnergyVolume& energy, Window window, int number, const Tick& tick) { return DynamicSeams()(energy, window, number, tick); }

Seams::Seam DynamicSeams::operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick) const {
    const Columns columns(energy);
    if (!in_line(columns))
        throw Failure(fmt::format(
            "seam.dynamic needs columns in one line, as in images, but there are {} x {} x {} columns (lateral, k, frames); use seam.pyramid or seam.graph_cut",
            columns.laterals(), columns.slices(), columns.frames()));
    tick(0);
    if (closes(columns)) return exact_seam(energy, window, number, [&] { tick(0); });
    return (*line_)(energy, window, number);
}

namespace {

struct Dynamic : SeamNode {
    void finish(const Params& params, Ports& io, Context& context) { solve(params, io, context, DynamicSeams()); }
};

}  // namespace

NodeType seam_dynamic() {
    Declare<Dynamic> node(
        "seam.dynamic",
        "Finds exact seams of least energy in images, by dynamic programming. For lattices one vertex thick, in one frame or with static seams.");
    return declare_solver(node);
}

}  // namespace fluidcarve
