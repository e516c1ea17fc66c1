#include "nodes/field/curl.h"

#include "nodes/field/collocate.h"
#include "nodes/field/differences.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct FieldCurl {
    struct Params {};
    struct Ports {
        Ref<VectorGrid> velocity, curl;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_stencil_fits(*io.velocity, sizeof(openvdb::Vec3s), context.memory_budget());
        io.curl = curl_field(io.velocity);
    }
};

}  // namespace

VectorGrid::Ptr curl_field(const Ref<VectorGrid>& velocity) {
    const auto out = map_stencil<VectorGrid>(*collocated(velocity), openvdb::Vec3s(0),
                                             [jacobian = Jacobian(*velocity)](auto& v, const openvdb::Coord& at) { return curl_at(v, at, jacobian); });
    out->setName("curl of " + velocity->getName());
    out->setVectorType(openvdb::VEC_COVARIANT);
    return out;
}

NodeType field_curl() {
    return Declare<FieldCurl>("field.curl", "The curl of a velocity: the axis of the flow's rotation, and twice its rate.")
        .input("velocity", &FieldCurl::Ports::velocity, "Velocity, world units per second; staggered grids are collocated.")
        .output("curl", &FieldCurl::Ports::curl, "curl velocity, 1/s, on the active voxels of `velocity`.")
        .kept();
}

}  // namespace fluidcarve
