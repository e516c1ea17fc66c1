#include "nodes/catalogue.h"

#include "nodes/energy.h"
#include "nodes/energy_image.h"
#include "nodes/expression/energy_ax.h"
#include "nodes/expression/field_ax.h"
#include "nodes/field.h"
#include "nodes/filter.h"
#include "nodes/grid.h"
#include "nodes/image.h"
#include "nodes/lattice.h"
#include "nodes/mask.h"
#include "nodes/mesh.h"
#include "nodes/page/page_node.h"
#include "nodes/payload/add_payloads.h"
#include "nodes/points.h"
#include "nodes/preview/sheet.h"
#include "nodes/python/python_nodes.h"
#include "nodes/remap.h"
#include "nodes/rig.h"
#include "nodes/sdf.h"
#include "nodes/seam.h"
#include "nodes/seams.h"
#include "nodes/time.h"
#include "nodes/usd.h"
#include "nodes/vdb.h"
#include "nodes/warp.h"

namespace fluidcarve {

Registry builtin_registry() {
    Registry out;
    add_grid_payloads(out);
    add_rig_payload(out);
    add_mesh_payload(out);
    add_lattice_payloads(out);
    add_seams_payload(out);
    add_frame_energy_payload(out);
    add_points_payload(out);
    add_ranges_payload(out);
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
    out.add(time_loop());
    out.add(time_loop_mesh());
    out.add(time_loop_points());
    out.add(time_retime());
    out.add(time_retime_mesh());
    out.add(time_retime_points());
    out.add(usd_write());
    return out;
}

}  // namespace fluidcarve
