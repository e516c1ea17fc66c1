#include "tests/bench/large/simulation.h"

#include "carve/points/point_grid.h"
#include "formats/vdb/vdb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <tuple>
#include <vector>

using openvdb::Coord;
using openvdb::Vec3f;

namespace {

/// Particles in a cell that is full of water.
constexpr float particles_per_cell = 8;

using FloatGrid = openvdb::FloatGrid;

/// How full of particles each cell is, 0 to 1.
FloatGrid::Ptr fullness(const openvdb::GridBase& particles) {
    auto out = FloatGrid::create();
    out->setTransform(particles.transform().copy());
    auto cells = out->getAccessor();
    for (const auto& position : fluidcarve::point_positions(particles))
        cells.modifyValue(Coord::floor(particles.worldToIndex(position)), [](float& full) {
            full = std::min(full + 1 / particles_per_cell, 1.0f);
        });
    return out;
}

/// What there is of a frame, as it is stored; null: nothing.
struct Stored {
    FloatGrid::ConstPtr density, flame;
    openvdb::Vec3SGrid::ConstPtr velocity;

    explicit Stored(const std::string& path) {
        const auto volume = fluidcarve::read_vdb(path);
        density = openvdb::gridConstPtrCast<FloatGrid>(volume.find("density"));
        flame = openvdb::gridConstPtrCast<FloatGrid>(volume.find("flame"));
        if (flame && flame->empty()) flame.reset();
        velocity = openvdb::gridConstPtrCast<openvdb::Vec3SGrid>(volume.find("velocity"));
        if (const auto particles = volume.find("particles"); !density && particles)
            density = fullness(*particles);
        if (!density || !velocity)
            throw std::runtime_error(
                fmt::format("{} has no density, or no velocity; it has {}", path, volume.names()));
    }
};

/// The value that came to each cell along the flow, from so many frames before; below 0: after.
template <class T>
Cells<T> moved(const Cells<T>& field, const Cells<Vec3f>& velocity, float frames) {
    return Cells<T>::filled(field.size, [&](const Coord& cell) {
        return field.linear(cell.asVec3s() - frames * velocity[cell]);
    });
}

template <class T>
Cells<T> mixed(Cells<T> a, const Cells<T>& b, float share) {
    for (std::size_t n = 0; n < a.values.size(); ++n)
        a.values[n] = (1 - share) * a.values[n] + share * b.values[n];
    return a;
}

}  // namespace

Simulation::Simulation(const std::string& files) {
    const auto token = files.find('#');
    digits_ = static_cast<int>(std::min(files.find_first_not_of('#', token), files.size()) - token);
    if (token == std::string::npos)
        throw std::runtime_error(fmt::format("{} has no ####, which stands for the frame", files));
    before_ = files.substr(0, token);
    after_ = files.substr(token + static_cast<std::size_t>(digits_));
    const std::filesystem::path path(before_);
    std::vector<int> frames;
    for (const auto& entry :
         std::filesystem::directory_iterator(path.has_parent_path() ? path.parent_path() : ".")) {
        const auto name = entry.path().filename().string(), stem = path.filename().string();
        if (!name.starts_with(stem) || !name.ends_with(after_) ||
            name.size() != stem.size() + static_cast<std::size_t>(digits_) + after_.size())
            continue;
        frames.push_back(std::stoi(name.substr(stem.size())));
    }
    if (frames.empty()) throw std::runtime_error(fmt::format("there are no files {}", files));
    std::tie(first_, last_) = std::pair(std::ranges::min(frames), std::ranges::max(frames));
    for (int number = first_; number <= last_; ++number) {
        const Stored stored(fmt::format("{}{:0{}}{}", before_, number, digits_, after_));
        box_.expand(stored.density->evalActiveVoxelBoundingBox());
        if (stored.flame) box_.expand(stored.flame->evalActiveVoxelBoundingBox());
        voxel_ = stored.density->voxelSize().x();
    }
}

const Simulation::Moment& Simulation::frame(int number) {
    if (const auto known = kept_.find(number); known != kept_.end()) return known->second;
    const Stored stored(fmt::format("{}{:0{}}{}", before_, number, digits_, after_));
    Moment out{Cells<float>(box_.dim()), Cells<float>(stored.flame ? box_.dim() : Coord(0)),
               Cells<Vec3f>(box_.dim())};
    const auto density = stored.density->getConstAccessor();
    const auto velocity = stored.velocity->getConstAccessor();
    for (auto each = box_.begin(); each; ++each) {
        const Coord at = *each;
        const auto n = out.density.place(at - box_.min());
        out.density.values[n] = density.getValue(at);
        if (stored.flame) out.flame.values[n] = stored.flame->tree().getValue(at);
        const Vec3f high(velocity.getValue(at.offsetBy(1, 0, 0)).x(),
                         velocity.getValue(at.offsetBy(0, 1, 0)).y(),
                         velocity.getValue(at.offsetBy(0, 0, 1)).z());
        out.velocity.values[n] = 0.5f * cells_per_unit * (velocity.getValue(at) + high);
    }
    std::erase_if(kept_, [&](const auto& known) { return std::abs(known.first - number) > 1; });
    return kept_.emplace(number, std::move(out)).first->second;
}

Simulation::Moment Simulation::at(double time) {
    const int earlier = std::clamp(static_cast<int>(std::floor(time)), 0, static_cast<int>(last()));
    const auto share = static_cast<float>(time - earlier);
    const auto a = frame(first_ + earlier);
    if (share <= 0 || earlier >= last()) return a;
    const auto& b = frame(first_ + earlier + 1);
    const auto between = [&](const auto& was, const auto& is) {
        return mixed(moved(was, a.velocity, share), moved(is, b.velocity, share - 1), share);
    };
    Moment out{between(a.density, b.density), {}, between(a.velocity, b.velocity)};
    if (!a.flame.values.empty() && !b.flame.values.empty()) out.flame = between(a.flame, b.flame);
    else if (!a.flame.values.empty()) out.flame = a.flame;
    return out;
}
