#include "tests/bench/large/make.h"

#include "formats/vdb/vdb_file.h"
#include "tests/bench/large/curl_noise.h"
#include "tests/bench/large/simulation.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3f;

namespace {

/// Density, or flame, below which there is nothing, at least.
constexpr float thinnest = 0.002f;

/// Wavelength of the largest swirls, cells of the simulation: smaller ones it does not hold itself.
constexpr float longest_wave = 4;
/// Wavelength of the smallest swirls, voxels.
constexpr float shortest_wave = 4;
/// How far a swirl displaces, in its wavelengths; and by how much it thickens, as an exponent of e.
constexpr float displaced = 0.1f, thickened = 0.25f;

/// Frames of the simulation in which swirls come, are carried along, and go.
constexpr double lifetime = 8;

/// Detail that the flow carries along. It comes in two layers: while one fades, the other is at its
/// full strength. Each begins anew when it is gone, before the flow has drawn it out too far.
class Detail {
public:
    Detail(const Coord& cells, double enlarged) : cells_(cells) {
        for (float wave = longest_wave;
             octaves_.empty() || wave * static_cast<float>(enlarged) >= shortest_wave; wave /= 2)
            octaves_.push_back(wave);
    }

    /// Goes on to a time.
    void move_to(double time, const Cells<Vec3f>& velocity) {
        for (std::size_t n = 0; n < layers_.size(); ++n) {
            auto& layer = layers_[n];
            const double age = time / lifetime + 0.5 * static_cast<double>(n);
            if (const int life = static_cast<int>(age); life != layer.life) begin(layer, life, n);
            else carry(layer, velocity, static_cast<float>(time - time_));
            layer.weight =
                static_cast<float>(std::pow(std::sin(M_PI * (age - std::floor(age))), 2));
        }
        time_ = time;
    }

    struct Swirl {
        Vec3f displacement;  ///< cells
        float exponent;      ///< of the density's factor
    };
    Swirl at(const Vec3f& cell) const {
        Vec3f displacement(0);
        float exponent = 0, squares = 0;
        for (const auto& layer : layers_) {
            if (layer.weight < 1e-3f) continue;
            const auto origin = layer.origins.linear(cell);
            for (std::size_t n = 0; n < octaves_.size(); ++n) {
                const auto swirl = layer.weight * noise_(origin / octaves_[n] + layer.shifts[n]);
                displacement += displaced * octaves_[n] * swirl;
                exponent += thickened * swirl.x();
            }
            squares += layer.weight * layer.weight;
        }
        const float scale = 1 / std::sqrt(squares);
        return {scale * displacement, scale * exponent};
    }

private:
    struct Layer {
        int life = -1;
        float weight = 0;
        Cells<Vec3f> origins;  ///< where what is in a cell was when the layer began
        std::vector<Vec3f> shifts;
    };

    void begin(Layer& layer, int life, std::size_t number) const {
        layer.life = life;
        layer.origins =
            Cells<Vec3f>::filled(cells_, [](const Coord& cell) { return cell.asVec3s(); });
        std::mt19937 random(static_cast<unsigned>(2 * static_cast<std::size_t>(life) + number));
        layer.shifts.clear();
        for (std::size_t n = 0; n < octaves_.size(); ++n) {
            Vec3f shift;
            for (int axis = 0; axis < 3; ++axis)
                shift[axis] = static_cast<float>(random() % 4096) / 64;
            layer.shifts.push_back(shift);
        }
    }
    static void carry(Layer& layer, const Cells<Vec3f>& velocity, float time) {
        layer.origins = Cells<Vec3f>::filled(velocity.size, [&](const Coord& cell) {
            return layer.origins.linear(cell.asVec3s() - time * velocity[cell]);
        });
    }

    Coord cells_;
    std::vector<float> octaves_;  ///< wavelengths, cells
    CurlNoise noise_{1};
    std::array<Layer, 2> layers_;
    double time_ = 0;
};

/// What is denser than nothing, so that at most a share of all cells is, in any frame.
float thinnest_for(Simulation& simulation, double share) {
    float out = thinnest;
    for (int frame = 0; frame <= static_cast<int>(simulation.last()); ++frame) {
        const auto moment = simulation.at(frame);
        auto values = moment.density.values;
        for (std::size_t n = 0; n < moment.flame.values.size(); ++n)
            values[n] = std::max(values[n], moment.flame.values[n]);
        const auto place =
            values.begin() +
            static_cast<std::ptrdiff_t>((1 - share) * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        out = std::max(out, *place);
    }
    return out;
}

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using VectorLeaf = openvdb::Vec3STree::LeafNodeType;

/// What was made of the 8 x 8 x 8 voxels at a place; null: nothing is there.
struct Block {
    std::unique_ptr<FloatLeaf> density, flame;
    std::unique_ptr<VectorLeaf> velocity;
};

class Enlarger {
public:
    explicit Enlarger(const MakeRequest& request)
        : request_(request),
          simulation_(request.files),
          cells_(simulation_.box().dim()),
          detail_(cells_, request.size.z() / double(cells_.z())) {
        for (int axis = 0; axis < 3; ++axis)
            cells_per_voxel_[axis] =
                static_cast<float>(cells_[axis]) / static_cast<float>(request.size[axis]);
        thinnest_ = thinnest_for(simulation_, request.active);
        made_.voxel = simulation_.voxel() * cells_per_voxel_.z();
        for (int axis = 0; axis < 3; ++axis)
            made_.stretch[axis] = cells_per_voxel_.z() / cells_per_voxel_[axis];
        time_per_frame_ = simulation_.last() / (request.frames - 1);
    }

    Made run(const std::function<void(int)>& tick) {
        made_.frames = request_.first_only > 0 ? std::min(request_.first_only, request_.frames)
                                               : request_.frames;
        for (int frame = 1; frame <= made_.frames; ++frame) {
            write(frame);
            tick(frame);
        }
        return made_;
    }

private:
    void write(int frame) {
        const double time = (frame - 1) * time_per_frame_;
        const auto moment = simulation_.at(time);
        detail_.move_to(time, moment.velocity);
        const CoordBBox leaves(Coord(0), (request_.size - Coord(1)) >> 3);
        std::vector<Block> blocks(static_cast<std::size_t>(leaves.volume()));
        tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t n) {
            const auto size = leaves.dim();
            const auto z = static_cast<int>(n % static_cast<std::size_t>(size.z())),
                       rest = static_cast<int>(n / static_cast<std::size_t>(size.z()));
            blocks[n] = block(moment, Coord(rest / size.y(), rest % size.y(), z) << 3);
        });

        auto density = openvdb::FloatGrid::create(), flame = openvdb::FloatGrid::create();
        auto velocity = openvdb::Vec3SGrid::create();
        for (auto& block : blocks) {
            if (!block.density) continue;
            density->tree().addLeaf(block.density.release());
            if (block.velocity) velocity->tree().addLeaf(block.velocity.release());
            if (block.flame) flame->tree().addLeaf(block.flame.release());
        }
        made_.active = std::max(made_.active, density->activeVoxelCount());
        fluidcarve::Volume volume;
        const auto add = [&](const openvdb::GridBase::Ptr& grid, const std::string& name,
                             openvdb::GridClass kind) {
            grid->setName(name);
            grid->setGridClass(kind);
            grid->setSaveFloatAsHalf(true);
            grid->setTransform(transform());
            volume.grids.push_back(grid);
        };
        add(density, "density", openvdb::GRID_FOG_VOLUME);
        if (!moment.flame.values.empty()) add(flame, "flame", openvdb::GRID_FOG_VOLUME);
        if (request_.velocity) add(velocity, "velocity", openvdb::GRID_UNKNOWN);
        const auto token = request_.out.find('#');
        const auto digits =
            std::min(request_.out.find_first_not_of('#', token), request_.out.size()) - token;
        const auto path = fmt::format("{}{:0{}}{}", request_.out.substr(0, token), frame, digits,
                                      request_.out.substr(token + digits));
        fluidcarve::write_vdb(path, volume, fluidcarve::Codec::blosc);
        made_.bytes += std::filesystem::file_size(path);
    }

    /// The large sequence's voxels lie in the small one's world, stretched.
    openvdb::math::Transform::Ptr transform() const {
        auto out = openvdb::math::Transform::createLinearTransform(made_.voxel);
        Vec3d corner;
        for (int axis = 0; axis < 3; ++axis)
            corner[axis] = made_.stretch[axis] * simulation_.voxel() *
                           (simulation_.box().min()[axis] - 0.5 + 0.5 * cells_per_voxel_[axis]);
        out->postTranslate(corner);
        return out;
    }

    Vec3f cell(const Coord& voxel) const {
        return (voxel.asVec3s() + Vec3f(0.5f)) * cells_per_voxel_ - Vec3f(0.5f);
    }

    /// Whether anything near these voxels is dense enough.
    bool may_hold(const Simulation::Moment& moment, const Coord& low) const {
        const float reach = 1.5f + 3 * displaced * 2 * longest_wave;
        const auto first = cell(low) - Vec3f(reach), last = cell(low.offsetBy(7)) + Vec3f(reach);
        for (int x = std::max(0, int(first.x())); x <= std::min(cells_.x() - 1, int(last.x()) + 1);
             ++x)
            for (int y = std::max(0, int(first.y()));
                 y <= std::min(cells_.y() - 1, int(last.y()) + 1); ++y)
                for (int z = std::max(0, int(first.z()));
                     z <= std::min(cells_.z() - 1, int(last.z()) + 1); ++z)
                    if (moment.density[{x, y, z}] > thinnest_ ||
                        (!moment.flame.values.empty() && moment.flame[{x, y, z}] > thinnest_))
                        return true;
        return false;
    }

    Block block(const Simulation::Moment& moment, const Coord& low) const {
        if (!may_hold(moment, low)) return {};
        Block out{std::make_unique<FloatLeaf>(low, 0.0f), nullptr, nullptr};
        if (request_.velocity) out.velocity = std::make_unique<VectorLeaf>(low, Vec3f(0));
        const bool burns = !moment.flame.values.empty();
        if (burns) out.flame = std::make_unique<FloatLeaf>(low, 0.0f);
        for (openvdb::Index n = 0; n < FloatLeaf::SIZE; ++n) {
            const auto voxel = low + FloatLeaf::offsetToLocalCoord(n);
            if (voxel.x() >= request_.size.x() || voxel.y() >= request_.size.y() ||
                voxel.z() >= request_.size.z())
                continue;
            const auto at = cell(voxel);
            const auto swirl = detail_.at(at);
            const auto from = at + swirl.displacement;
            const float factor = std::exp(swirl.exponent);
            const auto left = [&](const Cells<float>& field) {
                return std::max(0.0f, factor * field.smooth(from) - thinnest_);
            };
            const float density = left(moment.density), flame = burns ? left(moment.flame) : 0;
            if (density <= 0 && flame <= 0) continue;
            out.density->setValueOn(n, density);
            if (burns) out.flame->setValueOn(n, flame);
            if (request_.velocity)
                out.velocity->setValueOn(n, moment.velocity.linear(at) * velocity_scale());
        }
        if (out.density->isEmpty()) return {};
        return out;
    }

    /// From cells a frame to what is stored of voxels a frame.
    Vec3f velocity_scale() const {
        return static_cast<float>(time_per_frame_ / Simulation::cells_per_unit) / cells_per_voxel_;
    }

    const MakeRequest& request_;
    Simulation simulation_;
    Coord cells_;
    Detail detail_;
    Vec3f cells_per_voxel_;
    float thinnest_ = 0;
    double time_per_frame_ = 0;
    Made made_;
};

}  // namespace

Made make_sequence(const MakeRequest& request, const std::function<void(int)>& tick) {
    if (request.size.x() < 1 || request.size.y() < 1 || request.size.z() < 1 ||
        request.frames < 2 || !(request.active > 0 && request.active <= 1))
        throw std::runtime_error(
            "a size is at least 1, frames are at least 2, and the active share is above 0 % and at "
            "most 100 %");
    if (request.out.find('#') == std::string::npos)
        throw std::runtime_error(request.out + " has no ####, which stands for the frame");
    return Enlarger(request).run(tick);
}
