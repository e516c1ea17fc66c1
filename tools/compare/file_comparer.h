#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// How far two values may differ. Values are the same if their difference is at most the greater of
/// `absolute` and `relative` times the greater of the two.
struct Tolerance {
    double absolute = 0;
    double relative = 0;
    double warn = std::numeric_limits<double>::infinity();  ///< absolute difference above which a
                                                            ///< value is counted as warned of

    /// Nothing may differ: then a voxel that is active in one grid alone counts as one that
    /// differs, too.
    bool none() const { return absolute == 0 && relative == 0; }
};

/// The place of the greatest difference.
struct WorstPlace {
    /// Voxel, pixel from the lower left, or number of the vertex or point from 0.
    std::vector<std::int64_t> index;
    /// Centre of the voxel, or the position in the first file; images have none.
    std::optional<std::array<double, 3>> world;
    std::vector<double> a, b;  ///< both values; vectors have three numbers
};

/// The differences between two grids, channels, meshes or point sets of one name. Sums of several
/// frames are those of all their values.
struct PartDifference {
    std::string name;               ///< "density"; of a mesh "mesh"
    std::string values = "voxels";  ///< what is compared: "voxels", "pixels", "vertices", "points"
    /// Differences other than those of values: "only in A", "transform: ...".
    std::vector<std::string> faults;
    std::uint64_t compared = 0;  ///< values that are active in A or in B
    std::uint64_t over = 0;      ///< of these, those that differ by more than the tolerance
    std::uint64_t warned = 0;    ///< those that differ by more than Tolerance::warn
    std::uint64_t only_a = 0;    ///< those that are active in A only
    std::uint64_t only_b = 0;
    /// Those whose difference is no finite number; they are not part of the sums.
    std::uint64_t not_finite = 0;
    double sum = 0;                   ///< of the differences
    double squares = 0;               ///< of their squares
    double peak = 0;                  ///< the greatest difference; infinite if one is not finite
    std::optional<WorstPlace> worst;  ///< nothing: no values differ

    bool same() const {
        return faults.empty() && over == 0 && peak == 0 && only_a == 0 && only_b == 0;
    }
    /// Mean difference and root mean square of those that are finite.
    double mean() const;
    double rms() const;
    /// Adds the counts and sums of other values. The peak and faults stay what they are.
    void add_sums(const PartDifference& other);
    /// Adds the numbers of another frame. Faults stay what they are.
    /// @return whether its peak is the greater one, and was taken over
    bool add(const PartDifference& frame);
};

/// Two files, or two sequences, for messages and pictures.
struct FilePair {
    std::string a, b;
};

/// Compares files of one kind for `fluidcarve diff`.
struct FileComparer {
    std::vector<std::string> endings;  ///< file extensions: ".vdb"
    /// Compares two files: a result for each part of either, in the order of A, then those of B
    /// alone. Thread-safe.
    /// @param memory  bytes that a grid may take
    /// @throws Failure (input) if a file can't be read
    std::function<std::vector<PartDifference>(const FilePair& files, const Tolerance& tolerance,
                                              std::uint64_t memory)>
        compare;
    /// Draws slices of a part of A, of B and of their difference, through the worst place, as PNG.
    /// Null: can't be drawn.
    /// @param title  of the picture
    /// @throws Failure as `compare`, or if the picture can't be written
    std::function<void(const FilePair& files, const PartDifference& part, const std::string& title,
                       const std::string& png)>
        draw;
};

}  // namespace fluidcarve
