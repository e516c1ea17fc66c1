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

/// Frames that a sheet shows: the first, the last and between them in even steps; one alone is the middle one.
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
        if (check.stated("difference") && !connected("after")) check.fault("difference", "'difference' is that of 'after', which is not connected");
        const bool renders = params.show == SheetWish::Show::render;
        if (check.stated("difference") && params.difference && renders)
            check.fault("difference", "'show: render' has no difference; leave 'difference' out, or choose 'show: maximum'");
        if (check.stated("slice") && (renders || params.show == SheetWish::Show::maximum) && !connected("energy"))
            check.fault("slice", "nothing is sliced: 'slice' needs 'energy', or 'show: slice' or 'both'");
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
        if (!rows_) rows_.emplace(SheetWish{params.grid, params.axis, params.show, params.slice, params.difference});
        rows_->add(std::move(frame));
    }

    void finish(const Params& params, Ports&, Context& context) {
        if (!rows_) throw Failure("none of the frames to show has come");
        const auto page = rows_->page(context.frames().size(), [&](double fraction) {
            context.check_cancelled();
            context.progress(fraction);
        });
        draw_sheet(page).write_png(params.path.at(context.frame()));
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
                          "A picture of a grid before and after, of what differs and of the seams, for some frames of the sequence: is the carve where it "
                          "should be? Frames go across; all rows share one window, and rows of one kind one range of colours, printed beside them.")
        .input("before", &Sheet::Ports::before, "Usually what was read.")
        .input("after", &Sheet::Ports::after, "Usually what is written; shown in the same window and colours as `before`. Left out: only `before` is shown.")
        .input("energy", &Sheet::Ports::energy, "Energy in which the seams were found, shown as a slice.")
        .input("lattice", &Sheet::Ports::lattice, "The lattice in which the seams were found.")
        .input("seams", &Sheet::Ports::seams,
               "Drawn as lines over `energy`, where they cross the slice, at their places in `before`; needs `energy` and `lattice`. Choose an `axis` "
               "other than the carved one: along that, seams face the view and are not drawn.")
        .param("grid", &Sheet::Params::grid, "Name of the grid to show, in both volumes; of vectors, their length is shown. A render needs floats.")
        .param("axis", &Sheet::Params::axis, "Direction of view, an index axis of the grid. Up is z, or y where the view is along z.")
        .param("show", &Sheet::Params::show,
               "Of `before`, `after` and their difference: the `maximum` along the axis, a `slice` across it, or `both`. `render` shows `before` and `after` "
               "as smoke, lit from the upper left with its own shadows, and as glowing fire. A grid named `flame`, `temperature` or `heat` is fire, any other "
               "is smoke; the volume's `flame` comes with the smoke, its `density` with the fire. All renders share one exposure: the highest values of "
               "`before` in the frames shown are the thickest smoke and the brightest fire. The grids of these frames are kept until the last one has come. "
               "Energy and seams are always a slice.")
        .param("slice", &Sheet::Params::slice, Unit::voxels, any_number(),
               "Where slices are: the index coordinate along the axis. Auto is the middle of the active voxels of `before` in the frames shown; their grids "
               "are then kept until the last one has come, if they are to be sliced.")
        .param("difference", &Sheet::Params::difference,
               "Whether to show `after` minus `before`, voxel by voxel in index space; as a maximum, the largest difference along the axis with its sign, so "
               "that it is 0 only where nothing changes all along. Beyond a removed seam all content has moved and so differs. Renders have no difference.")
        .param("frames", &Sheet::Params::frames, Unit::frames, between(1, 12), "How many to show, evenly from the first to the last; 1 shows the middle one.")
        .required("path", &Sheet::Params::path, "PNG file, one for the whole sequence. Folders are made.");
}

}  // namespace fluidcarve
