#include "carve/field/laplacian.h"

#include "carve/field/jacobian.h"
#include "carve/field/stencil.h"

namespace fluidcarve {

FloatGrid::Ptr laplacian_field(const FloatGrid& field) {
    const auto metric = Jacobian(field).metric();
    const auto out =
        map_stencil<FloatGrid>(field, 0.0f, [&metric](auto& s, const openvdb::Coord& at) {
            const auto beside = [&](int axis, int by, int other = 0, int other_by = 0) -> double {
                auto place = at;
                place[axis] += by;
                place[other] += other_by;
                return s.getValue(place);
            };
            const double here = s.getValue(at);
            double sum = 0;
            for (int a = 0; a < 3; ++a) {
                sum += metric(a, a) * (beside(a, 1) - 2 * here + beside(a, -1));
                for (int b = a + 1; b < 3; ++b)
                    if (metric(a, b) != 0)
                        sum += 0.5 * metric(a, b) *
                               (beside(a, 1, b, 1) - beside(a, 1, b, -1) - beside(a, -1, b, 1) +
                                beside(a, -1, b, -1));
            }
            return static_cast<float>(sum);
        });
    out->setName("laplacian of " + field.getName());
    return out;
}

}  // namespace fluidcarve
