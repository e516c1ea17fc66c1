#include "formats/usd/stage.h"

#include "tests/support/files/usda.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

/// A part with fields of these names.
UsdStage::Part volume(const std::string& file, const std::vector<std::string>& grids) {
    UsdStage::Part out{"smoke", PathPattern(file), UsdFields{}};
    for (const auto& name : grids)
        out.fields->fields.push_back({name, 0, "float", "fogVolume", {}});
    return out;
}

}  // namespace

TEST_CASE(
    "a stage names the files of volumes, meshes and points at each frame, as they lie from it") {
    UsdStage stage{{-2, 0, 3},
                   23.976,
                   UsdStage::Up::y,
                   0.01,
                   {{"bank", PathPattern("/s/out/geo/bank.####.usda"), std::nullopt}}};
    auto smoke = volume("/s/vdb/smoke.####.vdb", {"density"});
    smoke.fields->fields.push_back({"vel", 1, "half3", "staggered", "Vector"});
    smoke.fields->placement = {openvdb::Vec3d(1.5, 0, -3), 2};
    stage.parts.push_back(smoke);
    stage.parts.push_back({"wall", PathPattern("/s/out/wall.usda"), std::nullopt});
    CHECK(stage_text(stage, "/s/out/shot.usda") == R"(#usda 1.0
(
    defaultPrim = "shot"
    endTimeCode = 3
    framesPerSecond = 23.976
    metersPerUnit = 0.01
    startTimeCode = -2
    timeCodesPerSecond = 23.976
    upAxis = "Y"
)

def Xform "shot"
{
    def "bank" (
        clips = {
            dictionary default = {
                double2[] active = [(-2, 0), (0, 1), (3, 2)]
                asset[] assetPaths = [@./geo/bank.-002.usda@, @./geo/bank.0000.usda@, @./geo/bank.0003.usda@]
                asset manifestAssetPath = @./geo/bank.0000.usda@
                string primPath = "/geometry"
            }
        }
        prepend references = @./geo/bank.0000.usda@
    )
    {
    }

    def Volume "smoke"
    {
        rel field:density = </shot/smoke/density>
        rel field:vel = </shot/smoke/vel>
        double3 xformOp:translate = (1.5, 0, -3)
        double3 xformOp:scale = (2, 2, 2)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]

        def OpenVDBAsset "density"
        {
            token fieldClass = "fogVolume"
            token fieldDataType = "float"
            int fieldIndex = 0
            token fieldName = "density"
            asset filePath.timeSamples = {
                -2: @../vdb/smoke.-002.vdb@,
                0: @../vdb/smoke.0000.vdb@,
                3: @../vdb/smoke.0003.vdb@,
            }
        }

        def OpenVDBAsset "vel"
        {
            token fieldClass = "staggered"
            token fieldDataType = "half3"
            int fieldIndex = 1
            token fieldName = "vel"
            asset filePath.timeSamples = {
                -2: @../vdb/smoke.-002.vdb@,
                0: @../vdb/smoke.0000.vdb@,
                3: @../vdb/smoke.0003.vdb@,
            }
            token vectorDataRoleHint = "Vector"
        }
    }

    def "wall" (
        prepend references = @./wall.usda@
    )
    {
    }
}
)");
}

TEST_CASE("fields have legal names, all different, and keep those of their grids") {
    const UsdStage stage{
        {7}, 24, UsdStage::Up::z, 1, {volume("out/a.vdb", {"vel.x", "vel_x", "2 \"d\""})}};
    const auto file = test::UsdaReader::read(stage_text(stage, "out/shot.usda"));
    CHECK(file.metadata.at("upAxis").text == "Z");
    CHECK(file.metadata.at("startTimeCode").text == "7");
    const auto& smoke = file.prim("shot").prim("smoke");
    REQUIRE(smoke.prims.size() == 3);
    CHECK(smoke.properties.size() == 3);
    CHECK(smoke.properties.at("rel field:vel_x_2").text == "/shot/smoke/vel_x_2");
    CHECK(smoke.prim("vel_x").properties.at("token fieldName").text == "vel.x");
    CHECK(smoke.prim("vel_x_2").properties.at("token fieldName").text == "vel_x");
    CHECK(smoke.prim("_2__d_").properties.at("token fieldName").text == "2 \"d\"");
    CHECK(smoke.prim("vel_x").properties.at("asset filePath").text == "./a.vdb");
}

TEST_CASE("a stage names its files alike from wherever it is written") {
    const auto asset = [](const std::string& file, const std::string& path) {
        const UsdStage stage{{1}, 24, UsdStage::Up::z, 1, {volume(file, {"d"})}};
        return test::UsdaReader::read(stage_text(stage, path))
            .prim("shot")
            .prim("smoke")
            .prim("d")
            .properties.at("asset filePath")
            .text;
    };
    CHECK(asset("a.vdb", "shot.usda") == "./a.vdb");
    CHECK(asset("./out/../a.vdb", "shot.usda") == "./a.vdb");
    CHECK(asset("../a.vdb", "out/shot.usda") == "../../a.vdb");
    CHECK(asset("out/vdb/a.vdb", "out/usd/shot.usda") == "../vdb/a.vdb");
    CHECK(asset("out/.hidden/a@b.vdb", "out/shot.usda") == "./.hidden/a@b.vdb");
    CHECK(asset("/s/a.vdb", "/s/out/shot.usda") == "../a.vdb");
}
