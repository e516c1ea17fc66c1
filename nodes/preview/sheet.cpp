#include "nodes/preview/sheet.h"

#include "nodes/preview/sheet_rows.h"

#include <fmt/format.h>

#include <optional>

namespace fluidcarve {

template <>
struct ChoiceNames<View> {
    static constexpr std::array names = {std::pair{"x", View::x}, std::pair{"y", View::y}, std::pair{"z", View::z}};
};

template <>
struct ChoiceNames<SheetWish::Show> {
    static constexpr std::array names = {std::pair{"maximum", SheetWish::Show::maximum}, std::pair{"slice", SheetWish::Show::slice},
                                         std::pair{"both", SheetWish::Show::both}, std::pair{"render", SheetWish::Show::render}};
};

namespace {

/// Whether a sheet shows a frame: the first, the last, and others in even steps between; a single one is the middle frame.
/// @param place  index of the frame in the sequence
bool shown(std::size_t place, std::size_t total, int wanted) {
    const auto count = std::min(total, static_cast<std::size_t>(wanted));
    if (count <= 1) return place == total / 2;
    for (std::size_t n = 0; n < count; ++n)
        if ((2 * n * (total - 1) + count - 1) / (2 * (count - 1)) == place) return true;
    return false;
}

openvdb::GridBase::ConstPtr grid_of(const Volume& volume, const char* input, const std::string& name) {
    const auto grid = volume.find(name);
    std::vector<std::string> names;
    for (const auto& each : volume.grids) names.push_back(each->getName());
    if (!grid) throw Failure(fmt::format("'{}' has no grid '{}'{}", input, name, did_you_mean(name, names)));
    if (!grid->isType<FloatGrid>() && !grid->isType<VectorGrid>())
        throw Failure(fmt::format("grid '{}' of '{}' holds {} values; a sheet shows grids of floats or vectors", name, input, grid->valueType()));
    return grid;
}

struct Sheet {
    struct Params {
        std::string grid = "density";
        View axis = View::y;
        SheetWish::Show show = SheetWish::Show::maximum;
        Auto<int> slice;
        bool difference = true;
        int frames = 3;
        OutputPath path;
    };
    struct Ports {
        Ref<Volume> before;
        Optional<Volume> after;
        Optional<FloatGrid> energy;
        Optional<Lattice> lattice;
        Optional<Seams> seams;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto connected = [&](const char* input) { return check.connections(input) > 0; };
        if (connected("seams") && !connected("energy")) check.fault("seams", "'seams' are drawn over 'energy'; connect it too");
        if (connected("seams") && !connected("lattice")) check.fault("seams", "'seams' needs 'lattice', in which they were found");
        if (connected("lattice") && !connected("seams")) check.fault("lattice", "'lattice' is for 'seams'; connect them too");
        if (check.stated("difference") && !connected("after"))
            check.fault("difference", "'difference' compares 'before' with 'after', but 'after' is not connected");
        const bool renders = params.show == SheetWish::Show::render;
        if (check.stated("difference") && params.difference && renders)
            check.fault("difference", "'show: render' has no difference; leave 'difference' out, or choose 'show: maximum'");
        if (check.stated("slice") && (renders || params.show == SheetWish::Show::maximum) && !connected("energy"))
            check.fault("slice", "nothing is sliced: 'slice' needs a connected 'energy', 'show: slice' or 'show: both'");
    }

    static bool wants(const Params& params, const Context& context) { return shown(context.place(), context.frames().size(), params.frames); }

    void add(const Params& params, const Ports& io, Context& context) {
        if (context.per_frame() && !wants(params, context)) return;
        SheetFrame frame;
        frame.name = context.per_frame() ? fmt::format("frame {}", context.frame()) : "all frames";
        frame.number = context.frame();
        frame.before = grid_of(*io.before, "before", params.grid);
        if (io.after) frame.after = grid_of(*io.after, "after", params.grid);
        if (frame.after && frame.after->type() != frame.before->type())
            throw Failure(
                fmt::format("grid '{}' holds {} values in 'before', but {} in 'after'", params.grid, frame.before->valueType(), frame.after->valueType()));
        if (frame.after && frame.after->transform() != frame.before->transform())
            context.warn(fmt::format("'{}' has another transform in 'after' than in 'before'; the sheet compares them voxel by voxel", params.grid));
        if (params.show == SheetWish::Show::render) {
            frame.before_scene = scene(*io.before, "before", frame.before, context);
            if (io.after) frame.after_scene = scene(*io.after, "after", frame.after, context);
        }
        frame.energy = io.energy;
        frame.lattice = io.lattice;
        frame.seams = io.seams;
        if (!rows_) rows_.emplace(SheetWish{params.grid, params.axis, params.show, params.slice, params.difference, context.memory_budget()});
        rows_->add(std::move(frame));
    }

    void finish(const Params& params, Ports&, Context& context) {
        if (!rows_) throw Failure("none of the frames to show was computed");
        const auto page = rows_->page(context.frames().size(), [&](double fraction) {
            context.check_cancelled();
            context.progress(fraction);
        });
        draw_sheet(page).write_png(params.path.at(context.frame()), context.provenance());
    }

private:
    static Scene scene(const Volume& volume, const char* input, const openvdb::GridBase::ConstPtr& shown, Context& context) {
        auto out = scene_of(volume, input, shown);
        if (!out.left_out.empty())
            context.warn(fmt::format("'{}' of '{}' is not rendered: it has another transform than '{}'", out.left_out, input, shown->getName()));
        return out;
    }

    std::optional<SheetRows> rows_;
};

}  // namespace

NodeType preview_sheet() {
    return Declare<Sheet>("preview.sheet",
                          "A picture to check a carve: a grid before and after, the difference and the seams, for some frames of the sequence. Frames go "
                          "across. All pictures show the same area; rows of one kind share a colour scale, which is printed beside them.")
        .input("before", &Sheet::Ports::before, "The grids before the carve, usually as read.")
        .input("after", &Sheet::Ports::after,
               "The grids after the carve, usually as written. Shown with the area and colours of `before`. Left out: only `before` is shown.")
        .input("energy", &Sheet::Ports::energy, "The energy in which the seams were found, shown as a slice.")
        .input("lattice", &Sheet::Ports::lattice, "The lattice in which the seams were found.")
        .input("seams", &Sheet::Ports::seams,
               "The seams, drawn as lines where they cross the slice of `energy`, at their places in `before`. Needs `energy` and `lattice`. Choose an `axis` "
               "other than the carved one: seams that face the viewer are not drawn.")
        .param("grid", &Sheet::Params::grid, "Name of the grid to show, in both volumes. Vectors are shown by their length. A render needs floats.")
        .param("axis", &Sheet::Params::axis, "Direction of view, an index axis of the grid. Up is z, or y if the view is along z.")
        .param("show", &Sheet::Params::show,
               "How to show `before`, `after` and their difference: `maximum` along the axis, `slice` across it, or `both`. `render` shows `before` and "
               "`after` as smoke, lit from the upper left with shadows, and as glowing fire. A grid named `flame`, `temperature` or `heat` is fire, any other "
               "is smoke; smoke is shown with the volume's `flame`, fire with its `density`. All renders share one exposure: the highest values of `before` in "
               "the frames shown are the thickest smoke and the brightest fire; so the grids of these frames stay in memory until the last one. Energy and "
               "seams are always a slice.")
        .param("slice", &Sheet::Params::slice, Unit::voxels, any_number(),
               "Position of slices: the index coordinate along the axis. Auto: the middle of the active voxels of `before` in the frames shown; grids to slice "
               "then stay in memory until the last of these frames.")
        .param("difference", &Sheet::Params::difference,
               "Whether to show `after` minus `before`, voxel by voxel in index space. In a `maximum` it is the difference of largest magnitude along the "
               "axis, with its sign: 0 only if nothing changes along the line. Beyond a removed seam all content has moved, and so differs. Renders have no "
               "difference.")
        .param("frames", &Sheet::Params::frames, Unit::frames, between(1, 12),
               "Number of frames to show, in even steps from the first to the last. 1: the middle one.")
        .required("path", &Sheet::Params::path, "PNG file, one for the whole sequence. Missing folders are made.");
}

}  // namespace fluidcarve
