#include "nodes/catalogue.h"

#include "nodes/energy/combine.h"
#include "nodes/energy/curvature.h"
#include "nodes/energy/gradient.h"
#include "nodes/energy/image.h"
#include "nodes/energy/kinetic.h"
#include "nodes/energy/payload_type.h"
#include "nodes/energy/remap.h"
#include "nodes/energy/surface.h"
#include "nodes/energy/volume.h"
#include "nodes/energy/vorticity.h"
#include "nodes/expression/energy_ax.h"
#include "nodes/expression/field_ax.h"
#include "nodes/field/collocate.h"
#include "nodes/field/curl.h"
#include "nodes/field/curvature.h"
#include "nodes/field/filter.h"
#include "nodes/field/gradient.h"
#include "nodes/field/laplacian.h"
#include "nodes/field/magnitude.h"
#include "nodes/grid/crop.h"
#include "nodes/grid/pick.h"
#include "nodes/grid/prune.h"
#include "nodes/grid/resample.h"
#include "nodes/image/read.h"
#include "nodes/image/write.h"
#include "nodes/io/payload_types.h"
#include "nodes/io/vdb_read.h"
#include "nodes/io/vdb_write.h"
#include "nodes/lattice/around_node.h"
#include "nodes/lattice/box.h"
#include "nodes/lattice/build_node.h"
#include "nodes/lattice/payload_types.h"
#include "nodes/lattice/write.h"
#include "nodes/mask/below_surface.h"
#include "nodes/mask/box.h"
#include "nodes/mask/combine.h"
#include "nodes/mask/dilate.h"
#include "nodes/mask/mesh.h"
#include "nodes/mask/sphere.h"
#include "nodes/mask/threshold.h"
#include "nodes/mask/weight.h"
#include "nodes/mesh/payload_type.h"
#include "nodes/mesh/read.h"
#include "nodes/mesh/write.h"
#include "nodes/page/page_node.h"
#include "nodes/points/keep_out.h"
#include "nodes/points/payload_type.h"
#include "nodes/points/read.h"
#include "nodes/points/write.h"
#include "nodes/preview/sheet.h"
#include "nodes/python/energy_python.h"
#include "nodes/python/field_python.h"
#include "nodes/python/mask_python.h"
#include "nodes/python/points_python.h"
#include "nodes/python/rig_python.h"
#include "nodes/python/seam_python.h"
#include "nodes/remap/grids.h"
#include "nodes/remap/mesh.h"
#include "nodes/remap/points.h"
#include "nodes/remap/seam_filter.h"
#include "nodes/rig/advect.h"
#include "nodes/rig/circle.h"
#include "nodes/rig/curve.h"
#include "nodes/rig/payload_type.h"
#include "nodes/rig/points.h"
#include "nodes/rig/transform.h"
#include "nodes/sdf/from_mesh.h"
#include "nodes/sdf/from_points.h"
#include "nodes/sdf/to_mesh.h"
#include "nodes/seam/costs/frame.h"
#include "nodes/seam/dynamic.h"
#include "nodes/seam/graph_cut.h"
#include "nodes/seam/greedy.h"
#include "nodes/seam/pyramid.h"
#include "nodes/seams/choose.h"
#include "nodes/seams/curves.h"
#include "nodes/seams/payload_type.h"
#include "nodes/seams/read.h"
#include "nodes/seams/write.h"
#include "nodes/time/carve.h"
#include "nodes/time/loop.h"
#include "nodes/time/retime.h"
#include "nodes/usd/write.h"
#include "nodes/warp/solve.h"

namespace fluidcarve {

Registry builtin_registry() {
    Registry out;
    add_payloads(out);
    add_rig_payload(out);
    add_mesh_payload(out);
    add_lattice_payloads(out);
    add_seams_payload(out);
    add_frame_energy_payload(out);
    add_points_payload(out);
    add_energy_payload(out);
    out.add(vdb_read());
    out.add(vdb_write());
    out.add(image_read());
    out.add(image_write());
    out.add(points_read());
    out.add(points_keep_out());
    out.add(points_python());
    out.add(points_write());
    out.add(mesh_read());
    out.add(mesh_write());
    out.add(grid_pick());
    out.add(grid_crop());
    out.add(grid_prune());
    out.add(grid_resample());
    out.add(field_gradient());
    out.add(field_curl());
    out.add(field_curvature());
    out.add(field_laplacian());
    out.add(field_magnitude());
    out.add(field_collocate());
    out.add(field_filter());
    out.add(field_ax());
    out.add(field_python());
    out.add(energy_vorticity());
    out.add(energy_kinetic());
    out.add(energy_gradient());
    out.add(energy_volume());
    out.add(energy_curvature());
    out.add(energy_surface());
    out.add(energy_image());
    out.add(energy_combine());
    out.add(energy_remap());
    out.add(energy_ax());
    out.add(energy_python());
    out.add(mask_threshold());
    out.add(mask_box());
    out.add(mask_sphere());
    out.add(mask_mesh());
    out.add(mask_below_surface());
    out.add(mask_combine());
    out.add(mask_dilate());
    out.add(mask_weight());
    out.add(mask_python());
    out.add(sdf_from_mesh());
    out.add(sdf_from_points());
    out.add(sdf_to_mesh());
    out.add(rig_points());
    out.add(rig_circle());
    out.add(rig_curve());
    out.add(rig_transform());
    out.add(rig_advect());
    out.add(rig_python());
    out.add(lattice_box());
    out.add(lattice_build());
    out.add(lattice_around());
    out.add(lattice_write());
    out.add(seam_dynamic());
    out.add(seam_graph_cut());
    out.add(seam_greedy());
    out.add(seam_pyramid());
    out.add(seam_python());
    out.add(warp_solve());
    out.add(seams_write());
    out.add(seams_curves());
    out.add(seams_read());
    out.add(seams_choose());
    out.add(remap_grids());
    out.add(remap_mesh());
    out.add(remap_points());
    out.add(filter_seam());
    out.add(preview_page());
    out.add(preview_sheet());
    out.add(time_carve());
    out.add(time_loop());
    out.add(time_retime());
    out.add(usd_write());
    return out;
}

}  // namespace fluidcarve
