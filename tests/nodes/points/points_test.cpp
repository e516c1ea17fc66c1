#include "nodes/points.h"
#include "carve/stream/openvdb_types.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/vdb.h"
#include "tests/support/files/point_files.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <openvdb/points/PointDataGrid.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

/// What differs between two files' grids; empty if nothing does.
std::string file_difference(const std::string& a, const std::string& b) {
    const auto first = read_vdb(a), second = read_vdb(b);
    if (first.names() != second.names()) return first.names() + " and " + second.names();
    if (first.codec != second.codec) return first.codec + " and " + second.codec;
    if (kept_metadata(first.metadata) != kept_metadata(second.metadata)) return "metadata";
    for (std::size_t n = 0; n < first.grids.size(); ++n)
        if (const auto words = difference(*first.grids[n].grid(), *second.grids[n].grid());
            !words.empty())
            return words;
    return {};
}

/// With an attribute `weights` of several floats, all of which are the number of the leaf, held as
/// one.
Points with_weights(const Points& points, const std::function<openvdb::Index(int)>& stride) {
    using namespace openvdb::points;
    const auto grid = points.grid->deepCopyGrid();
    int number = 0;
    for (auto leaf = static_cast<PointDataGrid&>(*grid).tree().beginLeaf(); leaf;
         ++leaf, ++number) {
        auto set = std::make_unique<AttributeSet>(leaf->attributeSet());
        const auto weights = set->appendAttribute(
            "weights", TypedAttributeArray<float>::attributeType(), stride(number));
        static_cast<TypedAttributeArray<float>&>(*weights).collapse(static_cast<float>(number));
        leaf->replaceAttributeSet(set.release(), true);
    }
    auto out = points;
    out.grid = grid;
    return out;
}

/// So many points in the voxel at the origin, right in its middle: held as one.
openvdb::GridBase::Ptr crowd(openvdb::Index count) {
    using namespace openvdb::points;
    auto leaf = std::make_unique<PointDataTree::LeafNodeType>();
    leaf->replaceAttributeSet(
        new AttributeSet(
            AttributeSet::Descriptor::create(TypedAttributeArray<openvdb::Vec3f>::attributeType()),
            count),
        true);
    leaf->setOffsets(
        std::vector<PointDataTree::ValueType>(PointDataTree::LeafNodeType::SIZE, count));
    const auto out = grid_of(ply_at({}));
    out->setName("crowd");
    static_cast<PointDataGrid&>(*out).tree().addLeaf(leaf.release());
    return out;
}

}  // namespace

TEST_CASE(
    "points of VDB files are written as they were read, alone and beside the file's other grids") {
    const Scratch scratch;
    const std::string path =
        GENERATE(as<std::string>{}, river_43, data + "/river/river_half.0012.vdb",
                 data + "/vdb/cortex_points.vdb");
    const auto offset = GENERATE(PointOffset::detect, PointOffset::none, PointOffset::half_voxel);
    const auto points = read_points(path, "", offset, {Vec3d(0.1, -3.3, 7.7), 1.7});
    const auto volume = read_vdb(path);
    write_points(scratch / "beside.vdb", points, &volume, nullptr, nullptr);
    CHECK(file_difference(scratch / "beside.vdb", path) == "");

    write_points(scratch / "alone.vdb", points, nullptr, nullptr, nullptr);
    const auto alone = read_vdb(scratch / "alone.vdb");
    REQUIRE(alone.grids.size() == 1);
    const auto was = volume.find(points.grid->getName());
    CHECK(difference(*alone.grids[0].grid(), *was) == "");
    CHECK(alone.codec == volume.codec);
}

TEST_CASE(
    "Blender's particles stand where its grids say, half a voxel from where their file does") {
    const Placement placement{Vec3d(0.03125, -1.56875, -0.06875), 1};
    const auto there = read_points(river_43, "", PointOffset::detect, placement),
               in_file = read_points(river_43, "", PointOffset::none, {});
    const auto a = there.positions(), b = in_file.positions();
    REQUIRE(a.size() == 12030);
    double worst = 0;
    // As Blender has them: the domain's corner, and the file's position.
    for (std::size_t n = 0; n < a.size(); ++n)
        worst = std::max(worst, (a[n] - (Vec3d(0, -1.6, -0.1) + b[n])).length());
    CHECK(worst < 1e-12);

    // A file that is not Blender's says what it means.
    const auto houdini = data + "/vdb/cortex_points.vdb";
    CHECK(read_points(houdini, "", PointOffset::detect, {}).positions() ==
          read_points(houdini, "", PointOffset::none, {}).positions());
    CHECK(read_points(houdini, "", PointOffset::half_voxel, {}).positions() !=
          read_points(houdini, "", PointOffset::none, {}).positions());
}

TEST_CASE(
    "where a file's grids don't tell how its points are meant, the writer says what to tell "
    "points.read") {
    const Scratch scratch;
    const auto points = read(river_43);
    const auto volume = read_vdb(river_43);
    CHECK(write_points(scratch / "beside.vdb", points, &volume, nullptr, nullptr).offset.empty());
    CHECK(read(scratch / "beside.vdb").positions() == points.positions());
    CHECK(write_points(scratch / "alone.vdb", points, nullptr, nullptr, nullptr).offset ==
          "half_voxel");
    CHECK(read_points(scratch / "alone.vdb", "", PointOffset::half_voxel, {}).positions() ==
          points.positions());
    CHECK(read(scratch / "alone.vdb").positions() != points.positions());
    const auto stated = read_points(river_43, "", PointOffset::none, {});
    CHECK(write_points(scratch / "alone.vdb", stated, nullptr, nullptr, nullptr).offset.empty());
    CHECK(write_points(scratch / "beside.vdb", stated, &volume, nullptr, nullptr).offset == "none");
    CHECK(write_points(scratch / "a.ply", points, nullptr, nullptr, nullptr).offset.empty());

    Told told;
    NodeBench writer(points_write(), "{path: " + (scratch / "a.vdb") + "}");
    const std::vector<int> frames{1};
    writer.run({{"source", {Payload(std::make_shared<Points>(points))}}},
               Context(told, frames).at(0));
    CHECK(told.warnings ==
          std::vector<std::string>{
              "points.read needs 'offset: half_voxel' for this file: without it, it "
              "reads the points half a voxel off"});
}

TEST_CASE(
    "points keep what their file says of itself beside grids that say nothing, or something else") {
    const Scratch scratch;
    auto points = in_vdb(points_at({Vec3d(1, 2, 3)}));
    points.metadata.insertMeta("shot", openvdb::Int32Metadata(7));
    points.metadata.insertMeta("take", openvdb::Int32Metadata(2));
    points.codec = "zip";
    Volume beside;
    beside.grids = {FloatGrid::create()};
    beside.metadata.insertMeta("shot", openvdb::StringMetadata("eight"));
    write_points(scratch / "a.vdb", points, &beside, nullptr, nullptr);
    const auto written = read_vdb(scratch / "a.vdb");
    CHECK(written.metadata.metaValue<std::string>("shot") == "eight");
    CHECK(written.metadata.metaValue<std::int32_t>("take") == 2);
    CHECK(written.codec == "zip");
    beside.codec = "none";
    write_points(scratch / "a.vdb", points, &beside, nullptr, nullptr);
    CHECK(read_vdb(scratch / "a.vdb").codec == "none");
    for (int n = 0; n < 2; ++n) beside.grids.push_back(points.grid);
    CHECK(failure_of([&] { write_points(scratch / "b.vdb", points, &beside, nullptr, nullptr); }) ==
          "'beside' has several grids of points 'points', and which of them to replace can't be "
          "told: write the points to a file of their own");
}

TEST_CASE("vdb.read places points among its grids as points.read does") {
    NodeBench reader(vdb_read(), "{path: " + river_43 + ", translate: [1, 2, 3], scale: 2}");
    const auto volume = reader.run({}).at("volume").as<Volume>();
    const auto points = read_points(river_43, "", PointOffset::detect, {Vec3d(1, 2, 3), 2});
    CHECK(point_positions(*volume->find("particles")) == points.positions());
    const Scratch scratch;
    write_vdb(scratch / "a.vdb", *volume);
    CHECK(file_difference(scratch / "a.vdb", river_43) == "");
}

TEST_CASE(
    "numbers of an ASCII file that are too small for their type are the nearest that it has") {
    const Scratch scratch;
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty double y\nproperty "
        "float z\nend_header\n";
    const auto at =
        read(scratch.write("a.ply", header + "-1e-46 1e-400 1.2e-45\n")).ply->position(0);
    CHECK(at == Vec3d(0, 0, std::numeric_limits<float>::denorm_min()));
    CHECK(std::signbit(at.x()));
}

TEST_CASE("points far from the world's origin find their place in a grid") {
    const Vec3d far(3e10, -1e10, 2e10);
    auto positions = scattered({Vec3d(-5), Vec3d(5)}, 500, 21);
    for (auto& at : positions) at += far;
    const auto grid = in_vdb(points_at(positions));
    const auto ids = grid.identities();
    const auto there = grid.positions();
    REQUIRE(there.size() == positions.size());
    for (std::size_t n = 0; n < there.size(); ++n)
        REQUIRE((there[n] - positions[ids[n]]).length() < 2e-5);
}

TEST_CASE("a writer is told apart by its path's ending, and says what does not fit it") {
    CHECK(NodeBench(points_write(), "{path: a.PLY}", {{"beside", 1}}).faults() ==
          "beside: a PLY file holds points alone; write a .vdb, or the grids with vdb.write\n");
    CHECK(NodeBench(points_write(), "{path: a.vdb, encoding: ascii}").faults() ==
          "encoding: is for PLY files; the path does not end in .ply\n");
    CHECK(NodeBench(points_write(), "{path: a.ply, encoding: ascii}").faults() == "");
    CHECK(NodeBench(points_read(), "{path: a.ply, offset: half_voxel}").faults() ==
          "offset: is for VDB files; a PLY file has its points where they are\n");
    CHECK(NodeBench(points_read(), "{path: a.vdb, offset: half_voxel}").faults() == "");
    CHECK(NodeBench(points_read(), "{path: a.vdb, missing: hold}").faults() ==
          "missing: 'hold' is for sequences; the path has no frame token such as ####\n");
}

TEST_CASE("points.read looks at its files before a run") {
    const Scratch scratch;
    scratch.write("a.0001.ply", typical_ascii);
    scratch.write("a.0003.ply", typical_ascii.substr(0, 60));
    const auto survey = [&](const std::string& missing) {
        return NodeBench(points_read(),
                         "{path: " + (scratch / "a.####.ply") + ", missing: " + missing + "}")
            .survey({1, 2, 3});
    };
    CHECK(survey("error").absent.at(2) == (scratch / "a.0002.ply") + " does not exist");
    CHECK(survey("error").absent.at(3).find("cut off") != std::string::npos);
    CHECK(survey("skip").left_out == std::set<int>{2});
    CHECK(survey("hold").absent.count(2) == 0);
    NodeBench reader(points_read(), "{path: " + (scratch / "a.####.ply") + ", missing: hold}");
    Context::Host host;
    const std::vector<int> frames{1, 2, 3};
    CHECK(reader.run({}, Context(host, frames).at(1)).at("points").as<Points>()->size() == 3);
}

TEST_CASE("a frame without particles is a list of none, and a file without points is refused") {
    const Scratch scratch;
    auto volume = read_vdb(river_43);
    for (auto& grid : volume.grids)
        if (is_point_grid(grid.header())) grid = grid->copyGridWithNewTree();
    write_vdb(scratch / "empty.vdb", volume);
    const auto none = read(scratch / "empty.vdb");
    CHECK(none.size() == 0);
    CHECK(none.positions().empty());
    write_points(scratch / "again.vdb", none, &volume, nullptr, nullptr);
    CHECK(file_difference(scratch / "again.vdb", scratch / "empty.vdb") == "");
    write_points(scratch / "a.ply", none, nullptr, nullptr, nullptr);
    CHECK(read(scratch / "a.ply").size() == 0);
    write_points(scratch / "b.vdb", read(scratch / "a.ply"), nullptr, nullptr, nullptr);
    CHECK(read(scratch / "b.vdb").size() == 0);

    CHECK(refusal(data + "/plume/plume.0051.vdb") ==
          "FILE has no points; it has velocity, density, shadow, temperature, flame");
    CHECK(failure_of([] { read_points(river_43, "velocity", PointOffset::detect, {}); }) ==
          river_43 + ": grid 'velocity' holds no points, it is of type Tree_vec3s_5_4_3");
    volume.grids.push_back(volume.grids.back());
    volume.grids.push_back(volume.find("particles"));
    write_vdb(scratch / "two.vdb", volume);
    CHECK(refusal(scratch / "two.vdb") ==
          "FILE has several grids with points, 'particles[0]' and 'particles[1]': say which with "
          "'grid:'");
}

TEST_CASE(
    "a VDB file of points that is cut off, or holds what is no position, is refused with the "
    "reason") {
    const Scratch scratch;
    const auto bytes = Scratch::read(river_43);
    CHECK(refusal(scratch.write("cut.vdb", bytes.substr(0, bytes.size() / 2)))
              .find("FILE is cut off: ") == 0);
    CHECK(refusal(scratch.write("no.vdb", "not at all")) == "FILE is not a VDB file");

    auto ply = ply_at({Vec3d(0), Vec3d(1, 2, 3)});
    const auto good = grid_of(ply);
    require_sound(*good, "a.vdb");
    const auto damaged = openvdb::gridPtrCast<openvdb::points::PointDataGrid>(good->deepCopyGrid());
    const auto leaf = damaged->tree().beginLeaf();
    openvdb::points::AttributeWriteHandle<openvdb::Vec3f>::create(leaf->attributeArray("P"))
        ->set(0, openvdb::Vec3f(1, std::nanf(""), 3));
    CHECK(failure_of([&] {
              require_sound(*damaged, "a.vdb");
          }).find("a.vdb is damaged: grid 'points': the position of a point in voxel [") == 0);
}

TEST_CASE(
    "attributes of several values per point stay with their points, also where a leaf holds them "
    "as one") {
    const auto points = with_weights(in_vdb(points_at(scattered({Vec3d(0), Vec3d(40)}, 3000, 22))),
                                     [](int) { return 12; });
    require_sound(*points.grid, "a.vdb");
    const auto positions = points.positions();
    std::vector<PointImage> images;
    // One in three moves far enough to come to another leaf.
    for (std::uint32_t n = 0; n < positions.size(); ++n)
        images.push_back({n, n % 3 == 0, positions[n] + Vec3d(0, 20, 0)});
    const auto moved = with_images(points, images);
    require_sound(*moved.grid, "a.vdb");
    std::vector<std::string> left_out;
    auto was = ply_of(*points.grid, left_out), is = ply_of(*moved.grid, left_out);
    REQUIRE(is.column("weights_11"));
    CHECK(PointTable::number(*was.column("weights_11"), was.size - 1) > 2);
    for (auto* const each : {&was, &is})
        each->columns.erase(each->columns.begin(), each->columns.begin() + 3);
    CHECK(sorted_rows(is) == sorted_rows(was));
}

TEST_CASE(
    "a VDB file whose points' attributes don't fit one another, or that states far more points "
    "than it holds, is refused") {
    const auto points = in_vdb(points_at(scattered({Vec3d(0), Vec3d(40)}, 3000, 23)));
    CHECK(failure_of([&] {
              require_sound(*with_weights(points, [](int leaf) { return leaf == 0 ? 2 : 3; }).grid,
                            "a.vdb");
          }) ==
          "a.vdb is damaged: grid 'points': it has an attribute of other lengths here than there");
    CHECK(failure_of([&] {
              require_sound(*with_weights(points, [](int) { return 3; }).grid, "a.vdb");
          }) == "");
    CHECK(failure_of([&] {
              require_sound(*with_weights(points, [](int) { return 1 << 28; }).grid, "a.vdb");
          }).find(" values in the voxels from [") != std::string::npos);

    const Scratch scratch;
    Volume volume;
    volume.grids = {crowd(8 * 512)};
    write_vdb(scratch / "few.vdb", volume);
    CHECK(read(scratch / "few.vdb").size() == 8 * 512);
    volume.grids = {crowd(100'000'000)};
    write_vdb(scratch / "many.vdb", volume);
    CHECK(refusal(scratch / "many.vdb")
              .find("FILE is damaged: grid 'crowd': it states 100000000 values in the voxels from "
                    "[0, 0, 0], more than the ") == 0);
}

TEST_CASE(
    "a list of some of the points, moved and copied, keeps their attributes in both kinds of "
    "file") {
    std::mt19937 random(3);
    std::vector<std::string> left_out;
    const auto ply = ply_of(*read_points(river_43, "", PointOffset::none, {}).grid, left_out);
    Points in_ply;
    in_ply.ply = std::make_shared<PointTable>(ply);
    const auto in_grid = read_points(river_43, "", PointOffset::none, {});
    const auto positions = in_grid.positions();

    std::vector<PointImage> images;
    auto wanted = ply;
    for (auto& each : wanted.columns) each.values.clear();
    wanted.size = 0;
    const auto keep = [&](std::uint32_t source, bool moved, const Vec3d& to) {
        images.push_back({source, moved, to});
        for (std::size_t c = 0; c < ply.columns.size(); ++c) {
            const auto size = bytes_of(ply.columns[c].type);
            const auto from =
                ply.columns[c].values.begin() + static_cast<std::ptrdiff_t>(source * size);
            wanted.columns[c].values.insert(wanted.columns[c].values.end(), from,
                                            from + static_cast<std::ptrdiff_t>(size));
        }
        if (moved) wanted.set_position(wanted.size, to);
        ++wanted.size;
    };
    for (std::uint32_t n = 0; n < positions.size(); ++n) {
        const auto fate = random() % 8;
        // Places that a float within its voxel holds exactly.
        const auto to = in_grid.grid->indexToWorld(
            Vec3d(std::floor(positions[n].x() * 16) + 24 + 0.25 * static_cast<double>(random() % 4),
                  20.125, 7));
        if (fate > 0) keep(n, fate == 1, to);
        if (fate == 2) keep(n, true, to);
    }
    const auto some_ply = with_images(in_ply, images);
    CHECK(some_ply.size() == images.size());
    for (std::size_t n = 0; n < images.size(); ++n)
        REQUIRE(row(*some_ply.ply, n) == row(wanted, n));

    const auto some = with_images(in_grid, images);
    require_sound(*some.grid, "result");
    CHECK(sorted_rows(ply_of(*some.grid, left_out)) == sorted_rows(wanted));
    // It is a grid that a file holds.
    const Scratch scratch;
    write_points(scratch / "a.vdb", some, nullptr, nullptr, nullptr);
    CHECK(difference(*read_vdb(scratch / "a.vdb").grids[0].grid(), *some.grid) == "");
}

TEST_CASE("a list of all points is the same grid, bit for bit, wherever it was placed") {
    for (const double scale : {1.0, 1.3, 0.7, 3.1}) {
        const auto points =
            read_points(river_43, "", PointOffset::detect, {Vec3d(0.1, 2, 3), scale});
        std::vector<PointImage> all;
        for (std::uint32_t n = 0; n < points.size(); ++n) all.push_back({n, false, {}});
        CHECK(difference(*with_images(points, all).grid, *points.grid) == "");
    }
}

TEST_CASE("texts, groups and codecs stay with their points") {
    const auto points = read(data + "/vdb/cortex_points.vdb");
    std::vector<PointImage> all;
    for (std::uint32_t n = 0; n < points.size(); ++n) all.push_back({n, false, {}});
    CHECK(difference(*with_images(points, all).grid, *points.grid) == "");
    // All moved far away and back again: only the order of leaves' points could differ, and here it
    // does not.
    const auto positions = points.positions();
    auto away = all, back = all;
    for (auto& image : away)
        image = {image.source, true, positions[image.source] + Vec3d(1000, 0, 0)};
    const auto far = with_images(points, away);
    CHECK(far.size() == points.size());
    const auto there = far.positions();
    for (auto& image : back) image = {image.source, true, there[image.source] - Vec3d(1000, 0, 0)};
    const auto again = with_images(far, back);
    std::vector<std::string> left_out;
    auto a = ply_of(*points.grid, left_out), b = ply_of(*again.grid, left_out);
    for (auto* const each : {&a, &b})
        each->columns.erase(each->columns.begin(), each->columns.begin() + 3);
    CHECK(sorted_rows(a) == sorted_rows(b));
}
