#include "carve/stream/grid_stream.h"
#include "carve/stream/openvdb_types.h"
#include "carve/stream/raw_grid.h"
#include "carve/volume/triplet.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/filed.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/point_lists.h"
#include "tests/support/scratch.h"

#include <openvdb/points/PointDataGrid.h>
#include <openvdb/tools/PointIndexGrid.h>
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::GridBase;
using openvdb::Vec3d;
using openvdb::math::Transform;

namespace {

const std::string test_data = TEST_DATA;
const Placement moved{{0.1, -2, 3.3}, 0.3, Vec3d(0)};

/// Values that a file of half floats would round and one that saves inactive values by what
/// compares equal would change.
FloatGrid::Ptr rough_grid() {
    const auto out = FloatGrid::create(0.1f);
    auto& tree = out->tree();
    tree.addTile(1, {8, 0, 0}, 1.0f / 3, true);
    tree.addTile(2, {128, 0, 0}, -0.7f, false);
    tree.addTile(3, {-4096, 0, 0}, 1e-30f, true);
    tree.touchLeaf({64, 64, 64});
    tree.setValueOff({64, 64, 65}, -0.0f);
    tree.setValueOff({64, 64, 66}, 0.0f);
    tree.setValueOff({64, 64, 67}, std::bit_cast<float>(0x7fc12345u));
    tree.setValueOff({64, 64, 68}, std::numeric_limits<float>::denorm_min());
    tree.setValueOn({64, 64, 69}, 0.1f);
    tree.setValueOn({64, 64, 70}, 1e30f);
    auto& zeros = *tree.touchLeaf({0, 64, 64});
    zeros.fill(0.0f, false);
    zeros.setValueOff(5, -0.0f);
    out->setSaveFloatAsHalf(true);
    out->setGridClass(openvdb::GRID_LEVEL_SET);
    out->setCreator("a test");
    out->insertMeta("shutter", openvdb::Vec3DMetadata({0.1, 0.2, 0.3}));
    std::istringstream bytes(std::string("\x03\0\0\0abc", 7));
    openvdb::UnknownMetadata strange("of_another_program");
    strange.read(bytes);
    out->insertMeta("strange", strange);
    return out;
}

template <class Grid>
typename Grid::Ptr grid_of_two(const typename Grid::ValueType& background,
                               const typename Grid::ValueType& value) {
    const auto out = Grid::create(background);
    out->tree().setValueOn({1, 2, 3}, value);
    out->tree().addTile(2, {-128, 0, 0}, value, true);
    return out;
}

GridBase::Ptr raw_grid(const std::shared_ptr<RawGrid::Bytes>& bytes) {
    const auto out = std::make_shared<RawGrid>("Tree_float_5_4_2", 0, 0);
    out->setTree(bytes);
    out->insertMeta("note", openvdb::StringMetadata("keep me"));
    out->setTransform(Transform::createLinearTransform(0.7));
    return out;
}

/// A little of all that a frame may hold.
Ref<Volume> rich_volume() {
    register_openvdb_types();
    const auto out = std::make_shared<Volume>();
    const auto put = [&](const GridBase::Ptr& grid, const std::string& name) {
        grid->setName(name);
        out->grids.push_back(grid);
        return grid;
    };
    put(rough_grid(), "surface")
        ->setTransform(Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0, 0.1));
    const auto density = put(rough_grid(), "density");
    density->setTransform(Transform::createLinearTransform(
        openvdb::math::Mat4d(0., .1, 0., 0., -.1, 0., 0., 0., 0., 0., .2, 0., 3., 4., 5., 1.)));
    const auto same_tree = put(density->copyGrid(), "density");
    same_tree->setGridClass(openvdb::GRID_FOG_VOLUME);
    same_tree->setSaveFloatAsHalf(false);
    same_tree->transform().postScale(Vec3d(1, 2, 3));
    const auto velocity = grid_of_two<VectorGrid>({0.1f, -0.0f, 3}, {0.3f, 1e-20f, 7});
    velocity->setSaveFloatAsHalf(true);
    velocity->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    velocity->setGridClass(openvdb::GRID_STAGGERED);
    put(velocity, "velocity");
    put(grid_of_two<openvdb::Int32Grid>(-3, 70000), "");
    put(grid_of_two<openvdb::Int64Grid>(-3, std::int64_t{1} << 40), "long");
    put(grid_of_two<openvdb::DoubleGrid>(1e-300, 1.0 / 3), "double")->setSaveFloatAsHalf(true);
    put(grid_of_two<openvdb::Vec3DGrid>(Vec3d(1e-300), Vec3d(0.1, 0.2, 0.3)), "wide");
    put(grid_of_two<openvdb::Vec3IGrid>(openvdb::Vec3i(-1), openvdb::Vec3i(1, 2, 3)), "whole");
    put(grid_of_two<openvdb::BoolGrid>(true, false), "bool");
    put(grid_of_two<MaskGrid>(false, true), "mask");
    put(FloatGrid::create(-0.0f), "empty");
    const auto bytes = std::make_shared<RawGrid::Bytes>();
    bytes->topology = std::string("\0\1\2", 3);
    bytes->buffers = "four";
    bytes->compression = 6;
    put(raw_grid(bytes), "rare");
    put(raw_grid(bytes), "rare");
    out->metadata.insertMeta("project", openvdb::StringMetadata("fluidcarve"));
    out->metadata.insertMeta("shot", openvdb::Int32Metadata(7));
    out->codec = "zip";
    return out;
}

void require_same_stored(const Volume& a, const Volume& b) {
    REQUIRE(a.names() == b.names());
    for (std::size_t n = 0; n < a.grids.size(); ++n) {
        CHECK(difference(*a.grids[n].grid(), *b.grids[n].grid()) == "");
        CHECK((stored_form_of(*a.grids[n].grid()) == nullptr) ==
              (stored_form_of(*b.grids[n].grid()) == nullptr));
    }
    CHECK(kept_metadata(a.metadata) == kept_metadata(b.metadata));
    CHECK(a.codec == b.codec);
}

/// What a writer makes of a volume, but for the identifier that each file has of its own.
std::string written(const Volume& volume, const Placement* placement = nullptr) {
    const Scratch scratch;
    write_vdb(scratch / "out.vdb", volume, Codec::as_read, placement);
    auto out = Scratch::read(scratch / "out.vdb");
    constexpr std::size_t uuid_at = 21, uuid_size = 36;
    return out.replace(uuid_at, uuid_size, "");
}

Volume volume_of(const GridBase::ConstPtr& grid) { return {{grid}, {}, {}}; }

Ref<AnyGrid> any(const GridBase::ConstPtr& grid) {
    return std::make_shared<AnyGrid>(AnyGrid{grid});
}

/// As a reader makes it of three grids, each on its faces, of which one says that it holds half
/// floats.
VectorGrid::ConstPtr velocity_of_three() {
    std::array<FloatGrid::ConstPtr, 3> components;
    for (int axis = 0; axis < 3; ++axis) {
        const auto grid = FloatGrid::create(0.1f);
        for (int x = 0; x < 5 + axis; ++x)
            grid->tree().setValue({x, 1, 2}, 0.1f * static_cast<float>(x + axis));
        const auto transform = Transform::createLinearTransform(0.2);
        Vec3d at(1, 2, 3);
        at[axis] -= 0.1;
        transform->postTranslate(at);
        grid->setTransform(transform);
        grid->setName(triplet_names("vel")[static_cast<std::size_t>(axis)]);
        grid->setSaveFloatAsHalf(axis == 1);
        grid->insertMeta("axis", openvdb::Int32Metadata(axis));
        components[static_cast<std::size_t>(axis)] = grid;
    }
    return merged(make_triplet("vel", components));
}

const Transform& in_file_of(const GridBase& grid) { return *stored_form_of(grid)->in_file; }

}  // namespace

TEST_CASE(
    "a volume comes back from a file to the last bit: order, names, transforms, metadata, shared "
    "trees, all types") {
    const auto before = rich_volume();
    const auto back = there_and_back(before);
    require_same_stored(*before, *back);
    CHECK(&back->grids[1]->constBaseTree() == &back->grids[2]->constBaseTree());
    CHECK(&back->grids[0]->constBaseTree() != &back->grids[1]->constBaseTree());
    const auto& raw = dynamic_cast<const RawGrid::Bytes&>(back->grids.back()->constBaseTree());
    CHECK(&raw == &back->grids[back->grids.size() - 2]->constBaseTree());
    CHECK(RawGrid::of(*back->grids.back().grid()));
    CHECK(raw.topology == std::string("\0\1\2", 3));
    CHECK(raw.buffers == "four");
    CHECK(raw.compression == 6);
    auto known = *before, known_back = *back;
    known.grids.resize(known.grids.size() - 2);
    known_back.grids.resize(known.grids.size());
    CHECK(written(known) == written(known_back));
    require_same_stored(Volume{}, *there_and_back<Volume>(std::make_shared<Volume>()));
}

TEST_CASE("a grid that says that it holds half floats keeps what is none, and says so again") {
    const Ref<FloatGrid> before = rough_grid();
    const auto back = there_and_back(before);
    CHECK(difference(*before, *back) == "");
    CHECK(back->saveFloatAsHalf());
    CHECK(back->background() == 0.1f);
    CHECK(back->tree().getValue({64, 64, 69}) == 0.1f);
    CHECK(back->tree().getValue({8, 0, 0}) == 1.0f / 3);
    CHECK(std::signbit(back->tree().getValue({64, 64, 65})));
    CHECK_FALSE(std::signbit(back->tree().getValue({64, 64, 66})));
    CHECK(std::bit_cast<std::uint32_t>(back->tree().getValue({64, 64, 67})) == 0x7fc12345u);
    CHECK(before->saveFloatAsHalf());
}

TEST_CASE("vectors, masks and any one grid come back from a file") {
    const Ref<VectorGrid> vectors = grid_of_two<VectorGrid>({0.1f, 0, 0}, {1, 2, 3});
    CHECK(difference(*vectors, *there_and_back(vectors)) == "");
    const Ref<MaskGrid> mask = grid_of_two<MaskGrid>(false, true);
    CHECK(difference(*mask, *there_and_back(mask)) == "");
    const auto volume = rich_volume();
    for (const auto& grid : volume->grids)
        CHECK(difference(grid.header(), *there_and_back(any(grid))->grid) == "");
}

TEST_CASE(
    "files of other programs come back from a file, and a writer gives the same file from them") {
    for (const auto* path : {"/plume/plume.0051.vdb", "/river/river.0043.vdb",
                             "/river/river_half.0012.vdb", "/vdb/cortex_points.vdb"}) {
        INFO(path);
        const auto before = std::make_shared<const Volume>(read_vdb(test_data + path));
        const auto back = there_and_back(before);
        require_same_stored(*before, *back);
        CHECK(written(*before) == written(*back));
    }
}

TEST_CASE(
    "where a grid came from comes back with it: placement, transform, what a profile made of its "
    "class") {
    const auto placed_grid =
        placed(rich_volume()->grids[1], {{0.1, -2, 3.3}, 0.3, Vec3d(-0.5, 0.1, 0)});
    const auto back = there_and_back(any(placed_grid))->grid;
    REQUIRE(stored_form_of(*back));
    CHECK(stored_form_of(*back)->placement == stored_form_of(*placed_grid)->placement);
    CHECK(bytes(in_file_of(*back)) == bytes(in_file_of(*placed_grid)));
    CHECK(stored_form_of(*back)->components.empty());
    CHECK(written(volume_of(back)) == written(volume_of(placed_grid)));
    CHECK(written(volume_of(back), &moved) == written(volume_of(placed_grid), &moved));

    for (const bool in_file : {false, true}) {
        const auto staggered = grid_of_two<VectorGrid>({0, 0, 0}, {1, 2, 3});
        staggered->setGridClass(openvdb::GRID_STAGGERED);
        StoredForm origin;
        origin.made_staggered = true;
        origin.class_in_file = in_file;
        set_stored_form(*staggered, origin);
        const auto again = there_and_back<VectorGrid>(staggered);
        CHECK(again->getGridClass() == openvdb::GRID_STAGGERED);
        CHECK(written(volume_of(again)) == written(volume_of(staggered)));
        CHECK((*unplaced(again, nullptr))[GridBase::META_GRID_CLASS].operator bool() == in_file);
    }
}

TEST_CASE(
    "a vector that was read as three grids is those three again behind a file, untouched or "
    "changed") {
    const auto vel = velocity_of_three();
    const auto placed_vel = openvdb::gridConstPtrCast<VectorGrid>(placed(vel, moved));
    for (const auto& before : {vel, placed_vel}) {
        const auto back = there_and_back(before);
        CHECK(stored_form_of(*back)->merged.lock() == back->constBaseTreePtr());
        REQUIRE(stored_form_of(*back)->components.size() == 3);
        for (std::size_t n = 0; n < 3; ++n)
            CHECK(difference(*stored_form_of(*before)->components[n],
                             *stored_form_of(*back)->components[n]) == "");
        CHECK(split(back)[0]->constBaseTreePtr() ==
              stored_form_of(*back)->components[0]->constBaseTreePtr());
        CHECK(written(volume_of(before)) == written(volume_of(back)));

        const auto changed = before->deepCopy();
        changed->tree().setValue({3, 1, 2}, openvdb::Vec3s(-1, 0.3f, -3));
        const auto changed_back = there_and_back<VectorGrid>(changed);
        CHECK(stored_form_of(*changed_back)->merged.expired());
        CHECK(written(volume_of(changed)) == written(volume_of(changed_back)));
        CHECK(written(volume_of(changed)) != written(volume_of(before)));
    }
}

TEST_CASE("components that stand in a volume beside their vector share their trees with it again") {
    const auto vel = velocity_of_three();
    const auto volume = std::make_shared<Volume>();
    volume->grids = {vel, stored_form_of(*vel)->components[1], vel->copyGrid()};
    const auto back = there_and_back<Volume>(volume);
    CHECK(&back->grids[1]->constBaseTree() ==
          &stored_form_of(*back->grids[0].grid())->components[1]->constBaseTree());
    CHECK(&back->grids[0]->constBaseTree() == &back->grids[2]->constBaseTree());
    CHECK(written(*volume) == written(*back));
}

TEST_CASE(
    "points of a VDB file come back from a file, and a writer gives the same file from them") {
    const Scratch scratch;
    for (const auto* name :
         {"/river/river.0043.vdb", "/river/river_half.0012.vdb", "/vdb/cortex_points.vdb"}) {
        INFO(name);
        const auto before = std::make_shared<const Points>(
            read_points(test_data + name, "", PointOffset::detect, moved));
        const auto back = there_and_back(before);
        CHECK(difference(*before->grid, *back->grid) == "");
        CHECK(kept_metadata(before->metadata) == kept_metadata(back->metadata));
        CHECK(before->codec == back->codec);
        CHECK(before->positions() == back->positions());
        CHECK(before->identities() == back->identities());
        CHECK_FALSE(back->ply);
        for (const auto* ending : {".ply", ".vdb"}) {
            const auto file = [&](const Points& points) {
                write_points(scratch / (std::string("out") + ending), points, nullptr, nullptr,
                             nullptr);
                return Scratch::read(scratch / (std::string("out") + ending))
                    .erase(21, std::string_view(ending) == ".vdb" ? 36 : 0);
            };
            CHECK(file(*before) == file(*back));
        }
    }
}

TEST_CASE("a stream of grids that is cut off is refused") {
    constexpr std::size_t all = 150;
    const Ref<FloatGrid> grid = rough_grid();
    require_cut_refused(grid, all);
    require_cut_refused(openvdb::gridConstPtrCast<VectorGrid>(placed(velocity_of_three(), moved)),
                        all);
    require_cut_refused<MaskGrid>(grid_of_two<MaskGrid>(false, true), all);
    require_cut_refused(any(rich_volume()->grids.back()));
    require_cut_refused(rich_volume(), all);
    require_cut_refused(std::make_shared<const Points>(read_points(
                            test_data + "/vdb/cortex_points.vdb", "", PointOffset::detect, moved)),
                        all);
}

TEST_CASE("a stream of grids that is damaged is refused or read, never a crash") {
    const Ref<FloatGrid> grid = rough_grid();
    require_damage_survived(grid, 997);
    require_damage_survived(
        openvdb::gridConstPtrCast<VectorGrid>(placed(velocity_of_three(), moved)), 4999);
    require_damage_survived(any(rich_volume()->grids.back()));
}

TEST_CASE(
    "a stream of points that is damaged is refused or read, never a crash, and takes no more "
    "memory than it is good for") {
    const auto points = std::make_shared<const Points>(
        read_points(test_data + "/vdb/cortex_points.vdb", "", PointOffset::detect, moved));
    require_damage_survived(points, 1 + filed(points).size() / 50);
    const Ref<AnyGrid> grid = any(in_vdb(points_at({{0.1, 0.2, 0.3}, {4, 5, 6}})).grid);
    require_damage_survived(grid, 1 + filed(grid).size() / 300);
}

TEST_CASE("point indices, which OpenVDB cannot read safely, are refused") {
    const auto name = openvdb::tools::PointIndexGrid::gridType();
    auto bytes = filed<FloatGrid>(FloatGrid::create());
    const std::string floats = FloatGrid::gridType();
    const std::uint64_t length = name.size();
    const auto at = bytes.find(floats);
    bytes.replace(at, floats.size(), name);
    std::memcpy(bytes.data() + at - sizeof length, &length, sizeof length);
    CHECK_THROWS_AS(read_back<AnyGrid>(bytes), Failure);
}

TEST_CASE("a grid is read only as what it is") {
    const auto floats = filed<FloatGrid>(rough_grid());
    CHECK_THROWS_AS(read_back<VectorGrid>(floats), Failure);
    CHECK(read_back<AnyGrid>(floats)->grid->isType<FloatGrid>());
    auto unknown = floats;
    unknown.replace(unknown.find("Tree_float"), 10, "Tree_tuple");
    CHECK_THROWS_AS(read_back<AnyGrid>(unknown), Failure);
}

TEST_CASE("a stream that could not take a grid says so") {
    std::ofstream full("/dev/full", std::ios::binary);
    const auto grid = FloatGrid::create(0);
    grid->denseFill({{0, 0, 0}, {31, 31, 31}}, 1.5f, true);
    GridWriter(full).write(*grid);
    CHECK(full.bad());
}
