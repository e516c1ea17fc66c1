#pragma once

#include "carve/lattice/lattice.h"
#include "carve/volume/volume.h"
#include "tests/bench/similarity.h"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A shipped pipeline, and what of it is looked at.
struct Scene {
    std::string pipeline;  ///< `plume` for pipelines/plume.yaml
    /// The pipeline's parameter that names its input, and the node that reads it.
    std::string input;
    std::string files;  ///< in a folder of data; `*`: each file there is a shot of its own
    std::vector<std::string> grids;   ///< what is seen: their mean; none: of all that there are
    std::vector<const char*> counts;  ///< of seams, or a share of the vertices along u
    std::string data = {};  ///< what is carved, if it is not what the pipeline is named after
};

/// A scene with its data.
struct Shot {
    Scene scene;
    std::string name;   ///< of the scene, and of the file if there may be several
    std::string files;  ///< whole path
    /// The first and the last frame; nothing: a single image.
    std::optional<std::pair<int, int>> range;
};

/// @return none if the folder holds no files of the scene
std::vector<Shot> find_shots(const Scene& scene, const std::string& folder);

/// What a pipeline made of a sequence, and in which space.
struct Carved {
    /// Of each frame, before the carve.
    std::vector<fluidcarve::Ref<fluidcarve::Lattice>> lattices;
    std::vector<fluidcarve::Ref<fluidcarve::Volume>> before, after;  ///< of each frame
    std::optional<std::array<double, 4>> windows;  ///< of seam pairs: first and last vertex of both
};

/// Runs the shipped pipeline as it is.
/// @param count  as a pipeline states it
Carved carve_as_shipped(const Shot& shot, const std::string& count);

/// The shipped pipeline, with a warp in place of its seams.
/// @param count  as a pipeline states it
Carved carve_by_warp(const Shot& shot, const std::string& count);

/// The shipped pipeline, with as many of its seams as look best, and a warp for the rest.
/// @param count  as a pipeline states it
/// @return nothing if there is no choice: the seams come in pairs, or have no field
std::optional<Carved> carve_by_both(const Shot& shot, const std::string& count);

/// The shipped pipeline, with a warp of even weights in place of its seams: even scaling, sampled
/// as often as any carve.
/// @param amount  vertices by which the lattice grows along u; need not be whole
Carved scale_evenly(const Shot& shot, double amount);

/// The paper's way: multi-greedy seams of backward energy, whole vertices move. To narrow, each
/// seam is carved before the next is looked for, in the lattice that is left of the first. To
/// widen, all are found at once: one after the other, the same seam would be doubled again and
/// again.
/// @param lattices  of each frame, before the carve
Carved carve_as_paper(const Shot& shot, int count,
                      const std::vector<fluidcarve::Ref<fluidcarve::Lattice>>& lattices);

/// The input at the lattices' vertices.
Samples samples_before(const Scene& scene, const Carved& carved);

/// The result at the vertices of the carved lattice: as many more along u as seams were inserted,
/// or fewer. It stands at the low end of the lattice, or where else it holds more.
/// @param grown  vertices along u, below 0 if the lattice shrinks
Samples samples_after(const Scene& scene, const Carved& carved, int grown);
