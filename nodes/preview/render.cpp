#include "nodes/preview/render.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "nodes/preview/picture_scene.h"

#include <fmt/format.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/RayIntersector.h>
#include <openvdb/tools/RayTracer.h>
#include <openvdb/tools/ValueTransformer.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;
using openvdb::tools::Film;
using Intersector = openvdb::tools::VolumeRayIntersector<FloatGrid>;
using Renderer = openvdb::tools::VolumeRender<Intersector>;
using Camera = openvdb::tools::OrthographicCamera;
using openvdb::tools::BoxSampler;

constexpr int finest = 2;  // maximum pixels per voxel; the page enlarges them smoothly

// Lengths are relative to the mean side of the box, so that a simulation looks the same at any
// resolution.
constexpr double smoke_depth = 50;  // optical depth of the thickest smoke over the mean side
constexpr double fire_depth = 60;   // emission of the brightest fire over the mean side
constexpr double albedo = 0.92;
constexpr double key_light = 0.92;
constexpr double ambient_light = 0.03;  // light from all sides, so that shadows are not black
constexpr double light_gain =
    0.02;  // how fast shadows fade with distance, an approximation of scattered light
constexpr double by_fire = 0.4;      // factor of both lights if the exposure includes fire
constexpr double fire_light = 7;     // strength of the fire's light on the smoke around it
constexpr double fire_reach = 0.06;  // reach of that light, in mean sides
constexpr std::array<double, 3> fire_colour{1, 0.32, 0.06};
// Direction to the light.
constexpr double light_right = -0.75;
constexpr double light_up = 0.6;
constexpr double light_front = 0.32;
// Of water: the light's height over the picture, low enough to tell slopes from calm places; and
// highlights.
constexpr double raking_front = 0.35;
constexpr double diffuse_light = 0.8, surface_ambient = 0.04, highlight = 0.5;
constexpr int shininess = 24;
constexpr int samples = 3;  // along a pixel's sides: outlines are smooth
// Steps along a ray, in voxels. They are longer in large boxes, so that time does not grow with the
// third power of the side.
constexpr double view_step = 1;
constexpr double most_view_steps = 100;  // per mean side
constexpr double shadow_step = 3;
constexpr double most_shadow_steps = 20;
constexpr double hidden = 0.004;  // transmittance that counts as opaque

/// The camera and the area that it sees.
struct ViewWindow {
    Area area;
    int width = 0, height = 0;
    double cell = 1;       // voxels per pixel
    double mean_side = 1;  // geometric mean of the box's sides, voxels
    Vec3d right{0.0}, up{0.0}, towards{0.0}, eye{0.0}, centre{0.0};

    ViewWindow(View view, const openvdb::CoordBBox& box) {
        const auto size = extents_of(box);
        mean_side = std::cbrt(static_cast<double>(size[0]) * static_cast<double>(size[1]) *
                              static_cast<double>(size[2]));
        area = face_of(box, view);
        const int longer = std::max(area.size(0), area.size(1));
        int voxels = 1;
        while (longer / voxels >= RenderedPicture::most_pixels) voxels *= 2;
        const int pixels = std::clamp(RenderedPicture::most_pixels / longer, 1, finest);
        const auto cells = in_cells(area, voxels);
        for (const int side : {0, 1}) {
            area.first[side] = cells.first[side] * voxels;
            area.last[side] = cells.last[side] * voxels + voxels - 1;
        }
        width = cells.size(0) * pixels;
        height = cells.size(1) * pixels;
        cell = static_cast<double>(voxels) / pixels;

        const auto [across, upwards] = picture_axes(view);
        const auto along = static_cast<int>(view);
        right[across] = up[upwards] = 1;
        towards = right.cross(up);
        centre[across] = (area.first[0] + area.last[0]) / 2.0;
        centre[upwards] = (area.first[1] + area.last[1]) / 2.0;
        centre[along] = (box.min()[along] + box.max()[along]) / 2.0;
        eye = centre + towards * (static_cast<double>(size[static_cast<std::size_t>(along)]) + 8.0);
    }

    double step() const { return std::max({view_step, mean_side / most_view_steps, cell}); }

    Camera camera(Film& film) const {
        Camera out(film, Vec3d(0), eye, width * cell);
        out.lookAt(centre, up);
        return out;
    }
};

/// A copy in index space, divided by the highest value. Inactive, negative and non-finite values
/// become 0.
FloatGrid::Ptr medium(const FloatGrid& grid, float highest) {
    auto out = FloatGrid::create();
    out->setTree(grid.tree().copy());
    openvdb::tools::foreach (out->beginValueAll(), [highest](const auto& value) {
        const float part = *value / highest;
        value.setValue(value.isValueOn() && std::isfinite(part) && part > 0 ? part : 0);
    });
    out->tree().root().setBackground(0, false);
    // The intersector dilates voxels but not tiles.
    out->tree().voxelizeActiveTiles();
    return out;
}

/// The same for a grid that may be null. @return null if nothing is visible
FloatGrid::Ptr medium(const FloatGrid::ConstPtr& grid, float highest) {
    return grid && highest > 0 && !grid->evalActiveVoxelBoundingBox().empty()
               ? medium(*grid, highest)
               : nullptr;
}

Film lit(const FloatGrid& smoke, const ViewWindow& window) {
    Film film(window.width, window.height);
    auto camera = window.camera(film);
    // Dilated by one voxel, since the sampler interpolates beyond active voxels. Must outlive the
    // renderer's copies, which refer to it.
    const Intersector whole(smoke, 1);
    Renderer renderer(whole, camera);
    const auto light =
        light_right * window.right + light_up * window.up + light_front * window.towards;
    renderer.setLightDir(light.x(), light.y(), light.z());
    renderer.setLightColor(key_light, key_light, key_light);
    const double thickness = smoke_depth / window.mean_side;
    const double scattering = thickness * albedo, absorption = thickness - scattering;
    renderer.setScattering(scattering, scattering, scattering);
    renderer.setAbsorption(absorption, absorption, absorption);
    renderer.setLightGain(light_gain);
    renderer.setPrimaryStep(window.step());
    renderer.setShadowStep(
        std::max({shadow_step, window.mean_side / most_shadow_steps, window.cell}));
    renderer.setCutOff(hidden);
    renderer.render();
    return film;
}

/// The light that a surface sends to the viewer.
/// @param middle  between the directions to light and viewer
double seen_light(const Vec3d& normal, const Vec3d& light, const Vec3d& middle) {
    return surface_ambient + diffuse_light * std::max(0.0, normal.dot(light)) +
           highlight * std::pow(std::max(0.0, normal.dot(middle)), shininess);
}

/// The surface of a level set, seen by its slopes.
Film lit_surface(const FloatGrid& water, const ViewWindow& window) {
    Film film(window.width, window.height);
    const auto camera = window.camera(film);
    // Index space at the scale of the distances.
    const double voxel = water.voxelSize().x();
    const auto distances =
        water.copyReplacingTransform(openvdb::math::Transform::createLinearTransform(voxel));
    using Surface = openvdb::tools::LevelSetRayIntersector<FloatGrid>;
    const Surface surface(*distances);
    const auto light = (light_right * window.right + light_up * window.up +
                        raking_front * window.towards)
                           .unit(),
               middle = (light + window.towards).unit();
    const auto draw = [&](const Surface& hits, int x, int y) {
        Vec3d place, normal;
        double brightness = 0;
        int hit = 0;
        for (int n = 0; n < samples * samples; ++n) {
            const auto ray =
                camera.getRay(x, y, (n % samples + 0.5) / samples, (n / samples + 0.5) / samples);
            const Surface::RayType scaled(voxel * ray.eye(), ray.dir());
            if (!hits.intersectsWS(scaled, place, normal)) continue;
            ++hit;
            brightness += seen_light(normal, light, middle);
        }
        constexpr double all = samples * samples;
        auto& pixel = film.pixel(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
        pixel.r = pixel.g = pixel.b = static_cast<float>(brightness / all);
        pixel.a = static_cast<float>(hit / all);
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, window.height), [&](const auto& rows) {
        const Surface hits(surface);
        for (int y = rows.begin(); y < rows.end(); ++y)
            for (int x = 0; x < window.width; ++x) draw(hits, x, y);
    });
    return film;
}

/// Light of the fire on the smoke around it: the blurred fire.
FloatGrid::Ptr fire_light_in(const FloatGrid& fire, const FloatGrid& smoke, double side) {
    auto out = FloatGrid::create();
    out->setTree(fire.tree().copy());
    out->tree().topologyUnion(smoke.tree());
    openvdb::tools::Filter<FloatGrid> filter(*out);
    filter.mean(std::max(1, static_cast<int>(std::lround(fire_reach * side))), 3);
    return out;
}

/// Light of the fire in one pixel: what comes through the smoke, times the gain, and what the smoke
/// scatters.
struct Glow {
    double fire = 0;
    double smoke = 0;
};

/// Gathers the light of the fire along rays.
class GlowRays {
public:
    /// @param smoke, light  of the fire in the smoke; null: there is no smoke
    GlowRays(const FloatGrid& fire, const FloatGrid* smoke, const FloatGrid* light,
             const ViewWindow& window, double gain)
        : fire_(fire.getConstAccessor()),
          smoke_((smoke ? *smoke : fire).getConstAccessor()),
          light_((light ? *light : fire).getConstAccessor()),
          smokes_(smoke),
          mean_side_(window.mean_side),
          step_(window.step()),
          gain_(gain) {}

    /// @param spans  of the ray, in which there may be something
    Glow along(const Intersector::RayType& ray,
               const std::vector<Intersector::RayType::TimeSpan>& spans) const {
        double through = 1, heat = 0, scattered = 0;
        for (const auto& span : spans)
            for (double at = step_ * std::ceil(span.t0 / step_); at < span.t1 && through > hidden;
                 at += step_) {
                const auto place = ray(at);
                const double flame = BoxSampler::sample(fire_, place);
                heat += through * flame * flame * fire_depth / mean_side_ * step_;
                if (!smokes_) continue;
                const double stays =
                    std::exp(-smoke_depth / mean_side_ * step_ * BoxSampler::sample(smoke_, place));
                scattered += through * (1 - stays) * BoxSampler::sample(light_, place);
                through *= stays;
            }
        return {1 - std::exp(-gain_ * heat), fire_light * scattered};
    }

private:
    FloatGrid::ConstAccessor fire_, smoke_, light_;
    bool smokes_;
    double mean_side_, step_, gain_;
};

std::vector<Glow> glow(const FloatGrid& fire, const FloatGrid* smoke, const ViewWindow& window,
                       double gain) {
    Film film(window.width, window.height);
    const auto camera = window.camera(film);
    FloatGrid::ConstPtr light;
    if (smoke) light = fire_light_in(fire, *smoke, window.mean_side);
    const Intersector whole(light ? *light : fire, 1);
    std::vector<Glow> out(film.numPixels());
    tbb::parallel_for(
        tbb::blocked_range<int>(0, window.height), [&](const tbb::blocked_range<int>& rows) {
            Intersector hits(whole);
            const GlowRays rays(fire, smoke, light.get(), window, gain);
            std::vector<Intersector::RayType::TimeSpan> spans;
            for (int y = rows.begin(); y < rows.end(); ++y)
                for (int x = 0; x < window.width; ++x) {
                    const auto ray = camera.getRay(x, y);
                    if (!hits.setIndexRay(ray)) continue;
                    hits.hits(spans);
                    out[static_cast<std::size_t>(y) * window.width + x] = rays.along(ray, spans);
                }
        });
    return out;
}

}  // namespace

std::vector<FloatGrid::ConstPtr> Scene::grids() const {
    std::vector<FloatGrid::ConstPtr> out{smoke, fire, water};
    std::erase(out, nullptr);
    return out;
}

openvdb::CoordBBox Scene::box() const {
    if (picture) return picture->box();
    openvdb::CoordBBox out;
    for (const auto& grid : grids()) {
        const auto active = grid->evalActiveVoxelBoundingBox();
        if (!active.empty()) out.expand(active);
    }
    return out;
}

bool glows(const std::string& name) {
    return name == "flame" || name == "temperature" || name == "heat";
}

Scene scene_of(const Volume& volume, const std::string& input,
               const openvdb::GridBase::ConstPtr& shown) {
    const auto grid = openvdb::gridConstPtrCast<FloatGrid>(shown);
    if (!grid)
        throw Failure(
            fmt::format("grid '{}' of '{}' holds {} values; 'show: render' needs floats: name "
                        "another grid, or choose 'show: maximum'",
                        shown->getName(), input, shown->valueType()));
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) return {nullptr, nullptr, {}, grid};
    if (auto picture = picture_in(volume, grid))
        return {nullptr, nullptr, {}, nullptr, std::move(picture)};
    const bool burns = glows(shown->getName());
    const auto other =
        openvdb::gridConstPtrCast<FloatGrid>(volume.find(burns ? "density" : "flame"));
    Scene out{grid, nullptr, {}};
    if (other && other->transform() == grid->transform()) out.fire = other;
    else if (other) out.left_out = other->getName();
    if (burns) std::swap(out.smoke, out.fire);
    return out;
}

void Exposure::meter(const Scene& scene) {
    const auto raise = [](float& highest, const FloatGrid::ConstPtr& grid) {
        if (!grid) return;
        for (auto value = grid->cbeginValueOn(); value; ++value)
            if (std::isfinite(*value)) highest = std::max(highest, *value);
    };
    raise(smoke, scene.smoke);
    raise(fire, scene.fire);
}

RenderedPicture render(const Scene& scene, View view, const openvdb::CoordBBox& box,
                       const Exposure& exposure) {
    if (scene.picture) return render_picture(*scene.picture, view, box, exposure.gain);
    const ViewWindow window(view, box);
    const auto smoke = medium(scene.smoke, exposure.smoke);
    const auto fire = medium(scene.fire, exposure.fire);
    const auto count = static_cast<std::size_t>(window.width) * window.height;

    std::optional<Film> film;
    if (smoke) film.emplace(lit(*smoke, window));
    else if (scene.water && !scene.water->empty()) film.emplace(lit_surface(*scene.water, window));
    std::vector<Glow> shine(count);
    if (fire) shine = glow(*fire, smoke.get(), window, exposure.gain);
    const double daylight = exposure.fire > 0 ? by_fire : 1;

    RenderedPicture out{window.area, {window.width, window.height, {}}};
    out.picture.pixels.reserve(count);
    const Film::RGBA clear(0.0, 0.0, 0.0, 0.0);
    for (std::size_t n = 0; n < count; ++n) {
        const auto& light = film ? film->pixels()[n] : clear;
        const double heat = shine[n].fire, scattered = shine[n].smoke;
        const auto flame = fluidcarve::flame(heat);
        const auto& [red, green, blue] = fire_colour;
        const auto shade = [&](double warm, std::uint8_t behind, std::uint8_t glow) {
            const double given = daylight * (light.r + ambient_light * light.a) + warm * scattered;
            const double seen = exposure.gain * given + of_screen(behind) * (1 - light.a);
            // Fire hides what is behind it.
            return screen_byte(on_screen(seen) * (1 - heat) * (1 - heat) + glow);
        };
        out.picture.pixels.push_back({shade(red, render_background.red, flame.red),
                                      shade(green, render_background.green, flame.green),
                                      shade(blue, render_background.blue, flame.blue)});
    }
    return out;
}

}  // namespace fluidcarve
