#include "carve/solver/dynamic.h"

#include "carve/base/failure.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/find_seams.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

namespace {

bool in_line(const Columns& columns) {
    return std::max({columns.laterals(), columns.slices(), columns.frames()}) == columns.count();
}

bool closes(const Columns& columns) { return columns.ring(0) || columns.ring(1); }

}  // namespace

bool in_open_line(const EnergyVolume& energy) {
    const Columns columns(energy);
    return in_line(columns) && !closes(columns);
}

Seams::Seam DynamicSeams::operator()(const EnergyVolume& energy, Window window, int number,
                                     const Tick& tick) const {
    const Columns columns(energy);
    if (!in_line(columns))
        throw Failure(
            fmt::format("seam.dynamic needs columns in one line, as in images, but there are {} x "
                        "{} x {} columns (lateral, k, frames); use seam.pyramid or seam.graph_cut",
                        columns.laterals(), columns.slices(), columns.frames()));
    tick(0);
    if (closes(columns)) return exact_seam(energy, window, number, [&] { tick(0); });
    return (*line_)(energy, window, number);
}

}  // namespace fluidcarve
