#include "nodes/preview/sheet_rows.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/dense.h"
#include "carve/field/extent.h"
#include "nodes/preview/difference.h"
#include "nodes/preview/slice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

using Show = SheetRequest::Show;

/// Calls `body` with one or two grids cast to their type, FloatGrid or VectorGrid.
template <class Body, class... Grids>
Projection typed(const Body& body, const openvdb::GridBase& first, const Grids&... others) {
    if (first.isType<FloatGrid>())
        return body(static_cast<const FloatGrid&>(first), static_cast<const FloatGrid&>(others)...);
    return body(static_cast<const VectorGrid&>(first), static_cast<const VectorGrid&>(others)...);
}

/// Draws the highest values of a grid along the view.
void draw_maximum(const openvdb::GridBase& grid, View view, const openvdb::CoordBBox& box,
                  SheetPanel& out) {
    if (box.empty()) out.note = "no active voxels";
    else
        out.projection =
            typed([&](const auto& each) { return maximum_projection(each, view, box); }, grid);
}

/// Draws the largest differences along the view.
void draw_change(const openvdb::GridBase& before, const openvdb::GridBase& after, View view,
                 const openvdb::CoordBBox& box, SheetPanel& out) {
    if (!box.empty())
        out.projection =
            typed([&](const auto& a, const auto& b) { return largest_difference(a, b, view, box); },
                  before, after);
    const auto& values = out.projection.values;
    if (std::ranges::none_of(values, [](float value) { return value < 0 || value > 0; }))
        out.note = "no difference";
}

std::string box_text(const openvdb::CoordBBox& box) {
    if (box.empty()) return {};
    const auto [x, y, z] = extents_of(box);
    return fmt::format("{} x {} x {} voxels", x, y, z);
}

std::string seams_text(const Seams& seams) {
    if (seams.warp) return fmt::format("a warp across {}", to_text(seams.axis));
    const bool removes = seams.kind == Seams::Kind::remove;
    return fmt::format("{} {} across {}{}", counted(seams.seams.size(), "seam"),
                       removes ? "removed" : "inserted", to_text(seams.axis),
                       !seams.paired() ? ""
                       : removes       ? ", as many inserted above"
                                       : ", as many removed above");
}

}  // namespace

bool SheetRows::shows(Show how) const {
    return std::ranges::find(request_.shows, how) != request_.shows.end();
}

void SheetRows::plan(const Shown& frame) {
    using What = Kind::What;
    for (const auto how : request_.shows) {
        kinds_.push_back({What::before, how});
        if (frame.data.after) kinds_.push_back({What::after, how});
        if (frame.data.after && request_.difference && how != Show::render)
            kinds_.push_back({What::difference, how});
    }
    if (frame.data.energy) kinds_.push_back({What::energy, Show::slice});
    panels_.resize(kinds_.size());
    axes_ = world_axes(*frame.space,
                       frame.before.empty() ? openvdb::Vec3d(0) : frame.before.getCenter(),
                       request_.view);
    face_ = frame.data.seams &&
            seams_face(*frame.data.lattice, frame.data.seams->axis, *frame.space, request_.view);
}

void SheetRows::add(SheetFrame data) {
    if (data.seams) require_seams(*data.lattice, *data.seams, data.number);
    Shown frame{std::move(data), {}, {}, {}, {}, {}};
    frame.space = frame.data.before->constTransformPtr();
    frame.before = frame.data.before->evalActiveVoxelBoundingBox();
    if (frame.data.after) frame.after = frame.data.after->evalActiveVoxelBoundingBox();
    require_room(frame);
    if (request_.lattice)
        frame.lattice = lattice_lines(*frame.data.lattice, *frame.space, request_.view);
    if (request_.rig) frame.rig = rig_lines(*frame.data.rig, *frame.space, request_.view);
    if (!frame.before.empty()) active_.expand(frame.before);
    if (frames_.empty()) plan(frame);
    for (std::size_t row = 0; row < kinds_.size(); ++row)
        panels_[row].push_back(kinds_[row].how == Show::slice
                                   ? SheetPanel()
                                   : panel(kinds_[row], frame, std::nullopt));
    scenes_.expand(frame.data.before_scene.box());
    scenes_.expand(frame.data.after_scene.box());
    exposure_.meter(frame.data.before_scene);
    picture_ = frame.data.before_scene.picture.has_value();
    if (!shows(Show::slice)) frame.data.before = frame.data.after = nullptr;
    frames_.push_back(std::move(frame));
    if (request_.slice) slice(frames_.size() - 1, *request_.slice);
}

void SheetRows::require_room(const Shown& frame) const {
    const auto& data = frame.data;
    const auto require = [](const openvdb::GridBase* grid) {
        if (grid) require_near(grid->getName(), grid->evalActiveVoxelBoundingBox());
    };
    for (const auto* grid : {data.before.get(), data.after.get()}) require(grid);
    require(data.energy.get());
    for (const auto* scene : {&data.before_scene, &data.after_scene}) {
        if (!scene->picture) continue;
        const auto box = scene->picture->box();
        require_near(request_.grid, box);
        if (!grid_fits(static_cast<double>(voxels_in(box)) * sizeof(float), request_.budget))
            throw Failure(fmt::format("the picture spans {}, which do not fit in --memory: crop it",
                                      span_text(box)));
    }
    for (const auto* scene : {&data.before_scene, &data.after_scene})
        for (const auto& grid : scene->grids()) {
            require(grid.get());
            if (grid != scene->water) require_dense_fits(*grid, sizeof(float), request_.budget);
        }
}

void SheetRows::slice(std::size_t t, int plane) {
    auto& frame = frames_[t];
    for (std::size_t row = 0; row < kinds_.size(); ++row)
        if (kinds_[row].how == Show::slice) panels_[row][t] = panel(kinds_[row], frame, plane);
    frame.data.before = frame.data.after = nullptr;
    frame.data.energy = nullptr;
}

void SheetRows::render(const std::function<void(double)>& progress) {
    for (std::size_t t = 0; t < frames_.size(); ++t)
        for (std::size_t row = 0; row < kinds_.size(); ++row) {
            if (kinds_[row].how != Show::render) continue;
            if (progress)
                progress(static_cast<double>(t * kinds_.size() + row) /
                         static_cast<double>(frames_.size() * kinds_.size()));
            auto& data = frames_[t].data;
            auto& scene =
                kinds_[row].what == Kind::What::before ? data.before_scene : data.after_scene;
            if (scene.box().empty()) panels_[row][t].note = "no active voxels";
            else
                panels_[row][t].render =
                    fluidcarve::render(scene, request_.view, scenes_, exposure_);
            scene = {};
        }
}

SheetPanel SheetRows::panel(const Kind& kind, const Shown& frame, std::optional<int> plane) const {
    SheetPanel out;
    const auto& [data, space, before, after, lattice, rig] = frame;
    const auto view = request_.view;
    out.lattice = lattice;
    out.rig = rig;
    const auto part = [&](const openvdb::CoordBBox& box) {
        return plane ? slice_of(box, view, *plane) : box;
    };
    const auto show = [&](const openvdb::GridBase& grid, const openvdb::CoordBBox& active) {
        const auto box = part(active);
        // If the grid is shown in another way, too, that row states the size.
        if (kind.how != Show::slice || request_.shows.size() == 1) out.caption = box_text(active);
        if (!active.empty()) out.active = face_of(active, view);
        if (kind.how == Show::render) return;
        draw_maximum(grid, view, box, out);
    };
    switch (kind.what) {
        case Kind::What::before: show(*data.before, before); break;
        case Kind::What::after:
            show(*data.after, after);
            if (!before.empty()) out.before = face_of(before, view);
            break;
        case Kind::What::difference: {
            auto both = before;
            if (!after.empty()) both.expand(after);
            draw_change(*data.before, *data.after, view, part(both), out);
            break;
        }
        case Kind::What::energy:
            out.projection = slice_in(*data.energy, *space, view, *plane);
            if (out.projection.empty()) out.note = "no active voxels";
            if (data.seams && request_.seams && !face_)
                out.seams =
                    seam_lines(*data.lattice, *data.seams, data.number, *space, view, *plane);
            break;
    }
    return out;
}

std::string SheetRows::name_of(const Kind& kind) const {
    switch (kind.what) {
        case Kind::What::before:
            return std::ranges::find(kinds_, Kind::What::after, &Kind::what) == kinds_.end()
                       ? "shown"
                       : "before";
        case Kind::What::after: return "after";
        case Kind::What::difference: return "difference";
        case Kind::What::energy: break;
    }
    const auto& seams = frames_.front().data.seams;
    return !seams || !request_.seams ? "energy"
           : seams->warp             ? "warp over energy"
                                     : "seams over energy";
}

std::string SheetRows::caption(const Kind& kind, int plane) const {
    const char axis = "xyz"[static_cast<int>(request_.view)];
    const auto slice = fmt::format("slice at {} = {}", axis, plane);
    if (kind.how == Show::render)
        return fmt::format(
            "{}seen along {}{}", picture_ ? "" : "lit, ", axis,
            request_.exposure != 0 ? fmt::format(", exposure {:+g}", request_.exposure) : "");
    const bool sliced = kind.how == Show::slice;
    if (kind.what == Kind::What::difference)
        return sliced ? "after - before, " + slice
                      : fmt::format("after - before, largest along {}", axis);
    if (kind.what != Kind::What::energy)
        return sliced ? slice : fmt::format("maximum along {}", axis);
    if (!frames_.front().data.seams || !request_.seams) return slice;
    if (face_) return slice + "; seams face this view, choose another axis";
    const auto& panels = panels_.back();
    const bool crossed =
        std::ranges::any_of(panels, [](const SheetPanel& panel) { return !panel.seams.empty(); });
    return crossed ? slice
                   : slice + (frames_.front().data.seams->warp
                                  ? "; the warp moves nothing by a whole vertex there"
                                  : "; no seam crosses it");
}

SheetPage SheetRows::page(std::size_t total, const std::function<void(double)>& progress) {
    const auto middle = active_.empty() ? 0 : active_.getCenter()[static_cast<int>(request_.view)];
    const int plane = request_.slice ? *request_.slice : static_cast<int>(std::floor(middle));
    const auto count = frames_.size();
    if (!request_.slice)
        for (std::size_t t = 0; t < count; ++t) slice(t, plane);
    exposure_.gain = std::exp2(request_.exposure);
    render(progress);

    SheetPage out;
    out.title = request_.grid;
    out.summary = fmt::format("{} of {}", count, counted(total, "frame"));
    if (const auto& seams = frames_.front().data.seams) {
        out.summary += "; " + seams_text(*seams);
        if (seams->warp) out.seams = "warp, by whole vertices";
    }
    out.axes = axes_;
    for (const auto& frame : frames_) out.frames.push_back(frame.data.name);
    for (std::size_t row = 0; row < kinds_.size(); ++row) {
        const auto& kind = kinds_[row];
        const auto scale = kind.how == Show::render              ? SheetRow::Scale::none
                           : kind.what == Kind::What::energy     ? SheetRow::Scale::energy
                           : kind.what == Kind::What::difference ? SheetRow::Scale::change
                                                                 : SheetRow::Scale::value;
        out.rows.push_back({name_of(kind), caption(kind, plane), scale, std::move(panels_[row])});
    }
    return out;
}

}  // namespace fluidcarve
