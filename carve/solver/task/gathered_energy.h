#pragma once

#include "carve/base/limits.h"
#include "carve/base/values.h"
#include "carve/field/same_transform.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/costs/frame_energy.h"
#include "carve/solver/costs/marks.h"
#include "carve/solver/costs/prices.h"
#include "carve/solver/costs/slab_prices.h"
#include "carve/solver/task/params.h"
#include "carve/solver/task/space.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A frame of a sequence.
struct FramePlace {
    int number = 1;          ///< for messages
    std::size_t place = 0;   ///< index in the sequence
    std::size_t frames = 1;  ///< number of frames in the sequence
};

/// Gathers the energy of a sequence frame by frame, with lattices, fields, mask counts and active
/// voxels.
class GatheredEnergy {
public:
    /// Adds a frame; frames come in their order. If the count of seams is 0, it only checks the
    /// frame.
    /// @throws Failure if the frame's lattice has another shape, or a grid another transform, than
    /// in the first frame; as FrameStore
    void add(const SolverParams& params, const FrameEnergy& frame, const FramePlace& at,
             const Limits& limits);

    /// Of the frames that were added.
    const std::vector<Ref<Lattice>>& lattices() const { return lattices_; }
    /// 1, or 2 if the frames came at half size. Then two frames become one, too: their mean.
    int finest() const { return finest_; }
    bool has_field() const { return has_field_; }       ///< whether the frames came with a field
    const MarkCounts& marks() const { return marks_; }  ///< in all frames, before `after` is carved
    /// Requires that some active voxel, if there are any, lies in the lattice of its frame.
    /// @throws Failure that says where both are
    void require_met() const;
    /// Share of the active voxels of all frames that lies in the lattice, 0 to 1; nothing: there
    /// are none.
    std::optional<double> content_share() const;
    /// Warnings about input that makes seams useless, although the search succeeds.
    std::vector<std::string> warnings() const;
    /// The energies of a sequence, and how thick its seams are.
    struct PricedEnergy {
        EnergyVolume energy;  ///< with the prices of thin seams; thick ones have prices of their
                              ///< own
        std::optional<Thick> thick;  ///< nothing: thin
        int thickness = 1;           ///< of the seams at full size, as Seams::thickness
    };
    /// Hands over the energies and fields of all frames, brought into a space. Prices are measured
    /// before the frames are carved. Call it once, after the last frame, if seams are wanted.
    /// @param space  made from lattices()
    /// @throws Failure as Typical::of(), CarvedSpace::carve_map() and FrameStore; if `thickness` is
    ///   wider than the axis
    PricedEnergy take_priced(const SolverParams& params, const CarvedSpace& space,
                             const Limits& limits);

    /// Energies and fields as sampled, and their typical values.
    struct SampledEnergy {
        EnergyVolume energy;
        Typical typical;
    };
    /// The same without prices of seams, for a warp. Codes hold marks, which are not counted.
    SampledEnergy take_sampled(const SolverParams& params, const CarvedSpace& space,
                               const Limits& limits);

private:
    /// The thickness of seams in entries of an energy; nothing if they are thin.
    std::optional<Thick> thick_for(const SolverParams& params, const EnergyVolume& energy) const;
    /// A volume whose energies are all 0.
    /// @param shape   I, J, K at full size
    /// @param frames  at full size
    /// @param budget  bytes of energies that may be held in memory, and as many of the field
    EnergyVolume room(const std::array<int, 3>& shape, std::size_t frames,
                      const SolverParams& params, const Limits& limits, std::uint64_t budget) const;
    /// Bytes of the memory budget for the energies. The field, and the energies without its edges,
    /// may take as much each.
    std::uint64_t budget(const Limits& limits) const {
        return limits.memory / (has_field_ ? 3 : 1);
    }
    /// What another volume leaves of the budget. One that is larger than the budget is in a file.
    std::uint64_t left_beside(const EnergyVolume& other, const Limits& limits) const;
    /// The energy of the whole lattice, repeated in the frames that share it.
    SampledEnergy uncarved();
    /// The energy in the space that earlier seams leave.
    SampledEnergy carved(const SolverParams& params, const CarvedSpace& space,
                         const Limits& limits);

    /// Adds the codes of a frame to the volume.
    void gather(const FrameEnergy& frame, std::size_t place);

    std::vector<Ref<Lattice>> lattices_;
    int finest_ = 1;
    std::optional<EnergyVolume> energy_;  ///< of the whole lattice
    /// For each frame of the volume, whether it has the codes of a frame.
    std::vector<bool> begun_;
    SameVoxels transform_, field_transform_;
    MarkCounts marks_;
    bool has_field_ = false;     ///< whether there is a field
    Content content_;            ///< of all frames
    openvdb::BBoxd active_box_;  ///< world box of all frames' active voxels
    std::uint16_t lowest_ = invalid_energy_code,
                  highest_ = 0;  ///< energy codes, marks left out; lowest > highest: none
};

}  // namespace fluidcarve
