#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

/// One field over a sequence, at the vertices of a lattice.
struct Samples {
    std::size_t frames = 0;
    std::array<std::size_t, 3> shape{};  ///< I, J, K; u is the carved axis
    bool closed = false;                 ///< plane K - 1 is followed by plane 0
    bool around = false;                 ///< vertex j = J - 1 is followed by j = 0
    std::vector<float> values;           ///< i fastest, then j, k and t

    Samples() = default;
    Samples(std::size_t frames, const std::array<std::size_t, 3>& shape, bool closed, bool around)
        : frames(frames),
          shape(shape),
          closed(closed),
          around(around),
          values(frames * shape[0] * shape[1] * shape[2]) {}

    std::size_t rows() const { return frames * shape[1] * shape[2]; }
    float* row(std::size_t n) { return values.data() + n * shape[0]; }
    const float* row(std::size_t n) const { return values.data() + n * shape[0]; }
};

/// How a carved sequence looks beside the same sequence scaled evenly: bidirectional similarity
/// (Simakov et al. 2008) in space and over time.
struct Looks {
    /// Of patches of 5, 9 and 15 vertices, then of 7 vertices over 5 frames if there are as many:
    /// root mean square distances, as shares of even scaling's.
    std::vector<double> coherence;  ///< from each patch of the result to the nearest of the input
    std::vector<double> completeness;  ///< from each patch of the input to the nearest of the
                                       ///< result; without the last
    std::optional<double> flicker;     ///< second difference in time per mass, as a share of the
                                       ///< input's own; of 3 frames or more
    double jagged = 0;  ///< second difference along u per mass, as a share of the input's own
    double mass = 0;    ///< the sum of all samples, as a share of even scaling's
    /// By how much what is visible became narrower or wider, as a share of what scaling all of the
    /// lattice would do; nothing if the lattice keeps its size.
    std::optional<double> resized;
    /// How much of the shape of details is kept: 1 if they are as long along u, by their
    /// correlation, as before, relative to the other dimensions; 0 if they changed as much as under
    /// even scaling. Nothing if even scaling changes nothing.
    std::optional<double> form;
    /// Patches that have their like beside them along u, as a share of those under even scaling: a
    /// comb of copies has many.
    double repeated = 0;
    /// Patches of the input that have nothing near to them in the result, as a share of those of
    /// even scaling: a crop has many.
    double lost = 0;

    double mean() const;   ///< of all similarities
    double worst() const;  ///< of them
};

/// What counts as visible: 0.02 of the value that one sample in a thousand exceeds.
float visible_from(const Samples& source);

/// In how many vertices along u something is visible, the mean over all planes and frames where
/// anything is.
double visible_width(const Samples& samples, float visible);

/// A sequence drawn out or pressed together along u, linear between samples.
/// @param width  vertices along u of the result
/// @param from   the place in the input of a vertex of the result, in vertices
Samples stretched(const Samples& source, std::size_t width,
                  const std::function<double(double)>& from);

/// @param even    the input scaled evenly until it is visibly as wide as the result
/// @param result  carved
/// @param moved   by how many vertices content may have moved; beyond 4 more, no nearest patch is
///   looked for
Looks looks_of(const Samples& result, const Samples& source, const Samples& even, int moved);
