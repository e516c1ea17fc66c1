#pragma once

#include "carve/base/values.h"
#include "carve/mesh/mesh.h"

#include <openvdb/math/Transform.h>
#include <tbb/collaborative_call_once.h>

#include <memory>
#include <mutex>

namespace fluidcarve {

/// Computes a grid from a mesh and a transform once for all frames that share both, such as the
/// frames of a static bank. Waiting frames help with the computation. Keeps only the last grid.
template <class GridT>
class MadeOnce {
public:
    /// @param mesh, transform  the inputs of the grid
    /// @param make             computes the grid: `make() -> std::shared_ptr<GridT>`
    /// @throws what `make` throws
    template <class Make>
    Ref<GridT> operator()(const Ref<Mesh>& mesh, const openvdb::math::Transform& transform,
                          const Make& make) const {
        const auto entry = entry_of(mesh, transform);
        tbb::collaborative_call_once(entry->once, [&] { entry->grid = make(); });
        return entry->grid;
    }

private:
    struct Entry {
        Ref<Mesh> mesh;
        openvdb::math::Transform::ConstPtr transform;
        tbb::collaborative_once_flag once;
        Ref<GridT> grid;
    };

    std::shared_ptr<Entry> entry_of(const Ref<Mesh>& mesh,
                                    const openvdb::math::Transform& transform) const {
        const std::lock_guard lock(mutex_);
        if (!last_ || last_->mesh != mesh || *last_->transform != transform) {
            last_ = std::make_shared<Entry>();
            last_->mesh = mesh;
            last_->transform = transform.copy();
        }
        return last_;
    }

    mutable std::mutex mutex_;
    mutable std::shared_ptr<Entry> last_;
};

}  // namespace fluidcarve
