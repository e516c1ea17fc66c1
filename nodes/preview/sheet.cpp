#include "nodes/preview/sheet.h"

#include "carve/base/words.h"
#include "nodes/params/file_sequence.h"
#include "nodes/preview/sheet_rows.h"
#include "nodes/preview/shown_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace fluidcarve {

template <>
struct ChoiceNames<View> {
    static constexpr std::array names = {std::pair{"x", View::x}, std::pair{"y", View::y},
                                         std::pair{"z", View::z}};
};

namespace {

/// A value of the parameter `show`; `both` is `maximum` and `slice`.
enum class Rows { maximum, slice, both, render };
enum class Overlay { lattice, rig, seams };

/// Names, stated as one or as a list.
template <class E>
struct Several {
    std::vector<E> all;
    bool has(E each) const { return std::ranges::find(all, each) != all.end(); }
};

}  // namespace

template <>
struct ChoiceNames<Rows> {
    static constexpr std::array names = {
        std::pair{"maximum", Rows::maximum}, std::pair{"slice", Rows::slice},
        std::pair{"both", Rows::both}, std::pair{"render", Rows::render}};
};

template <>
struct ChoiceNames<Overlay> {
    static constexpr std::array names = {std::pair{"lattice", Overlay::lattice},
                                         std::pair{"rig", Overlay::rig},
                                         std::pair{"seams", Overlay::seams}};
};

template <class E>
struct ParamTraits<Several<E>> {
    using List = ParamTraits<std::vector<E>>;
    static Shape shape() {
        return {.kind = Shape::Kind::any_of, .parts = {ParamTraits<E>::shape(), List::shape()}};
    }
    static std::optional<Several<E>> parse(const Value& value, ValueReader& reader) {
        if (value.kind == Value::Kind::scalar) {
            const auto one = ParamTraits<E>::parse(value, reader);
            return one ? std::optional(Several<E>{{*one}}) : std::nullopt;
        }
        if (value.kind != Value::Kind::list)
            return reader.unwanted(value, to_text(shape())), std::nullopt;
        auto all = List::parse(value, reader);
        return all ? std::optional(Several<E>{std::move(*all)}) : std::nullopt;
    }
    static std::string text(const Several<E>& value) {
        return value.all.size() == 1 ? ParamTraits<E>::text(value.all.front())
                                     : List::text(value.all);
    }
};

namespace {

std::vector<SheetRequest::Show> shows_of(const Several<Rows>& rows) {
    using Show = SheetRequest::Show;
    std::vector<Show> out;
    for (const auto each : rows.all) {
        if (each == Rows::render) out.push_back(Show::render);
        if (each == Rows::maximum || each == Rows::both) out.push_back(Show::maximum);
        if (each == Rows::slice || each == Rows::both) out.push_back(Show::slice);
    }
    return out;
}

openvdb::GridBase::ConstPtr grid_of(const Volume& volume, const char* input,
                                    const std::string& name) {
    require_grid(input, name, volume.given_names());
    auto grid = volume.find(name);
    if (!grid->isType<FloatGrid>() && !grid->isType<VectorGrid>())
        throw Failure(fmt::format(
            "grid '{}' of '{}' holds {} values; a sheet shows grids of floats or vectors", name,
            input, grid->valueType()));
    return grid;
}

struct Sheet {
    struct Params {
        std::string grid = "density";
        View axis = View::y;
        Several<Rows> show{{Rows::maximum}};
        Auto<int> slice;
        double exposure = 0;
        Several<Overlay> overlay{{Overlay::seams}};
        bool difference = true;
        int frames = 3;
        OutputPath path;
    };
    struct Ports {
        Ref<Volume> before;
        Optional<Volume> after;
        Optional<FloatGrid> energy;
        Optional<Lattice> lattice;
        Optional<Rig> rig;
        Optional<Seams> seams;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (const auto fault = drawing_fault(); !fault.empty()) check.fault("", fault);
        check_lines(params, check);
        const auto shows = shows_of(params.show);
        check_rows(shows, check);
        if (check.stated("path") && ending_of(params.path.text()) != ".png")
            check.fault("path", "'path' must end in .png; a sheet is a PNG file");
        check_use(params, shows, check);
    }

    /// Reports a missing grid before the run starts.
    static void survey(const Params& params, Survey& survey) {
        const auto total = survey.frames().size();
        const auto has = [&](const char* input) {
            return survey_grids(
                input, survey, [&](std::size_t t) { return is_shown(t, total, params.frames); },
                [&](const auto& there) { require_grid(input, params.grid, there); });
        };
        // A grid missing in `before` is mostly missing in `after`, too.
        if (has("before")) has("after");
    }

    static bool takes(const Params& params, const Context& context) {
        return is_shown(context.t(), context.frames().size(), params.frames);
    }
    static NodeTraits traits(const Params& params) {
        return {.takes = [&params](const Context& context) { return takes(params, context); }};
    }

    void add(const Params& params, const Ports& io, Context& context) {
        if (context.per_frame() && !takes(params, context)) return;
        SheetFrame frame;
        frame.name = context.per_frame() ? fmt::format("frame {}", context.frame()) : "all frames";
        frame.number = context.frame();
        frame.before = grid_of(*io.before, "before", params.grid);
        if (io.after) frame.after = grid_of(*io.after, "after", params.grid);
        if (frame.after && frame.after->type() != frame.before->type())
            throw Failure(fmt::format("grid '{}' holds {} values in 'before', but {} in 'after'",
                                      params.grid, frame.before->valueType(),
                                      frame.after->valueType()));
        if (frame.after && frame.after->transform() != frame.before->transform())
            context.warn(
                fmt::format("'{}' has another transform in 'after' than in 'before'; the sheet "
                            "compares them voxel by voxel",
                            params.grid));
        if (params.show.has(Rows::render)) {
            frame.before_scene = scene(*io.before, "before", frame.before, context);
            if (io.after) frame.after_scene = scene(*io.after, "after", frame.after, context);
        }
        frame.energy = io.energy;
        frame.lattice = io.lattice;
        frame.rig = io.rig;
        frame.seams = io.seams;
        if (!rows_) rows_.emplace(request_of(params, context));
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
    using Shows = std::vector<SheetRequest::Show>;

    static std::size_t number_of(SheetRequest::Show how, const Shows& shows) {
        return static_cast<std::size_t>(std::ranges::count(shows, how));
    }
    /// Inputs that are drawn as lines.
    static void check_lines(const Params& params, NodeCheck& check) {
        const auto connected = [&](const char* input) { return check.connections(input) > 0; };
        if (connected("seams") && !connected("energy"))
            check.fault("seams", "'seams' are drawn over 'energy'; connect it too");
        if (connected("seams") && !connected("lattice"))
            check.fault("seams", "'seams' needs 'lattice', in which they were found");
        if (connected("lattice") && !connected("seams") && !params.overlay.has(Overlay::lattice))
            check.fault("lattice",
                        "'lattice' is for 'seams', or to be drawn: connect 'seams', or state "
                        "'overlay: [lattice]'");
        if (connected("rig") && !params.overlay.has(Overlay::rig))
            check.fault("rig", "'rig' is to be drawn: state 'overlay: [rig]', or leave 'rig' out");
        if (check.stated("overlay"))
            for (const auto each : params.overlay.all)
                if (const auto name = ParamTraits<Overlay>::text(each); !connected(name.c_str()))
                    check.fault("overlay", fmt::format("'overlay' names '{0}', but the input '{0}' "
                                                       "is not connected; connect it",
                                                       name));
    }
    static void check_rows(const Shows& shows, NodeCheck& check) {
        if (shows.empty())
            check.fault("show", "'show' names nothing; name 'render', 'maximum' or 'slice'");
        for (const auto& [name, how] : {std::pair{"maximum", SheetRequest::Show::maximum},
                                        std::pair{"slice", SheetRequest::Show::slice},
                                        std::pair{"render", SheetRequest::Show::render}})
            if (number_of(how, shows) > 1)
                check.fault(
                    "show",
                    fmt::format("'show' names '{}' twice; 'both' is 'maximum' and 'slice'", name));
    }
    /// Parameters that the rows do not use.
    static void check_use(const Params& params, const Shows& shows, NodeCheck& check) {
        const auto renders = number_of(SheetRequest::Show::render, shows);
        if (check.stated("difference") && check.connections("after") == 0)
            check.fault(
                "difference",
                "'difference' compares 'before' with 'after', but 'after' is not connected");
        if (check.stated("exposure") && renders == 0)
            check.fault("exposure",
                        "'exposure' is for renders; choose 'show: render', or leave it out");
        if (check.stated("difference") && params.difference && renders > 0 &&
            renders == shows.size())
            check.fault("difference",
                        "'show: render' has no difference; leave 'difference' out, or choose "
                        "'show: maximum'");
        if (check.stated("slice") && number_of(SheetRequest::Show::slice, shows) == 0 &&
            check.connections("energy") == 0)
            check.fault("slice",
                        "nothing is sliced: 'slice' needs a connected 'energy', 'show: slice' or "
                        "'show: both'");
    }

    static SheetRequest request_of(const Params& params, const Context& context) {
        SheetRequest out;
        out.grid = params.grid;
        out.view = params.axis;
        out.shows = shows_of(params.show);
        out.exposure = params.exposure;
        out.lattice = params.overlay.has(Overlay::lattice);
        out.rig = params.overlay.has(Overlay::rig);
        out.seams = params.overlay.has(Overlay::seams);
        out.slice = params.slice;
        out.difference = params.difference;
        out.budget = context.limits().memory;
        return out;
    }

    static Scene scene(const Volume& volume, const char* input,
                       const openvdb::GridBase::ConstPtr& shown, Context& context) {
        auto out = scene_of(volume, input, shown);
        if (!out.left_out.empty())
            context.warn(
                fmt::format("'{}' of '{}' is not rendered: it has another transform than '{}'",
                            out.left_out, input, shown->getName()));
        return out;
    }

    std::optional<SheetRows> rows_;
};

}  // namespace

NodeType preview_sheet() {
    return Declare<Sheet>("preview.sheet",
                          "A picture to check a carve: a grid before and after, the difference and "
                          "the seams, for some frames of the sequence. Frames go across. All "
                          "pictures show the same area; rows of one kind share a colour scale, "
                          "which is printed beside them. The world's axes are drawn at the upper "
                          "right: a dot points at the viewer, a cross away.")
        .input("before", &Sheet::Ports::before, "The grids before the carve, usually as read.")
        .input("after", &Sheet::Ports::after,
               "The grids after the carve, usually as written. Shown with the area and colours of "
               "`before`. Left out: only `before` is shown.")
        .input("energy", &Sheet::Ports::energy,
               "The energy in which the seams were found, shown as a slice.")
        .input("lattice", &Sheet::Ports::lattice,
               "The lattice in which the seams were found, or one to draw.")
        .input("rig", &Sheet::Ports::rig,
               "A rig to draw, mostly that of the lattice. Needs `overlay` to name it.")
        .input("seams", &Sheet::Ports::seams,
               "The seams, drawn as lines where they cross the slice of `energy`, at their places "
               "in `before`. Of a warp, the places where it moves content by a whole number of "
               "vertices and a half. Needs `energy` and `lattice`. Choose an `axis` other than the "
               "carved one: seams that face the viewer are not drawn.")
        .param("grid", &Sheet::Params::grid,
               "Name of the grid to show, in both volumes. Vectors are shown by their length. A "
               "render needs floats.")
        .param(
            "axis", &Sheet::Params::axis,
            "Direction of view, an index axis of the grid. Up is z, or y if the view is along z.")
        .param(
            "show", &Sheet::Params::show,
            "How to show `before`, `after` and their difference: `maximum` along the axis, `slice` "
            "across it, or `both`; or a list, such as `[render, slice]`, whose rows follow each "
            "other in that order. A maximum hides all that is lost beside the highest value of "
            "each line of sight: look at a render first. `render` shows `before` and `after` as "
            "smoke, lit from the upper left with shadows, and as glowing fire. A grid named "
            "`flame`, `temperature` or `heat` is fire, a level set is the surface of water, lit at "
            "a low angle so that waves show, a channel of a picture is the whole picture in its "
            "colours, any other grid is smoke; smoke is shown with the volume's `flame`, fire with "
            "its `density`. All renders share one exposure: the highest values of `before` in the "
            "frames shown are the thickest smoke and the brightest fire; so the grids of these "
            "frames stay in memory until the last one. Energy and seams are always a slice.")
        .param("slice", &Sheet::Params::slice, Unit::voxels, any_number(),
               "Position of slices: the index coordinate along the axis. Auto: the middle of the "
               "active voxels of `before` in the frames shown; grids to slice then stay in memory "
               "until the last of these frames.")
        .param("exposure", &Sheet::Params::exposure, Unit::none, between(-10, 10),
               "Brightness of renders, in stops: each stop doubles the light of smoke and fire, so "
               "that faint smoke is seen; the background stays.")
        .param("overlay", &Sheet::Params::overlay,
               "What is drawn as lines, one name or a list; `[]` is nothing. `lattice` and `rig` "
               "go over all pictures, as they stand before the carve: of the lattice about 16 "
               "planes and its four edges along `w`. `seams` go over the slice of `energy`, where "
               "they cross it. The area shown grows to hold the lattice and the rig, but on no "
               "side by more than its own size.")
        .param("difference", &Sheet::Params::difference,
               "Whether to show `after` minus `before`, voxel by voxel in index space. In a "
               "`maximum` it is the difference of largest magnitude along the axis, with its sign: "
               "0 only if nothing changes along the line. Beyond a removed seam all content has "
               "moved, and so differs. Renders have no difference.")
        .param("frames", &Sheet::Params::frames, Unit::frames, between(1, 12),
               "Number of frames to show, in even steps from the first to the last. 1: the middle "
               "one.")
        .required("path", &Sheet::Params::path,
                  "File that ends in .png, one for the whole sequence. Missing folders are made.")
        .version(4);
}

}  // namespace fluidcarve
