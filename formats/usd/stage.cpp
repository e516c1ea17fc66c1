#include "formats/usd/stage.h"

#include "formats/file/full_path.h"
#include "formats/geometry_file/usda.h"

#include <fmt/format.h>

#include <filesystem>
#include <functional>

namespace fluidcarve {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view root = "shot";  ///< name of the prim that holds all others

/// Writes prims, each level indented.
class StageWriter {
public:
    StageWriter(const UsdStage& stage, const std::string& path)
        : stage_(stage), folder_(full_path(path).parent_path()) {}

    std::string text() {
        line("#usda 1.0");
        block("(", ")", [&] {
            line("defaultPrim = {}", usd_text(root));
            line("endTimeCode = {}", stage_.frames.back());
            line("framesPerSecond = {}", stage_.fps);
            line("metersPerUnit = {}", stage_.metres_per_unit);
            line("startTimeCode = {}", stage_.frames.front());
            line("timeCodesPerSecond = {}", stage_.fps);
            line("upAxis = {}", usd_text(stage_.up == UsdStage::Up::y ? "Y" : "Z"));
        });
        line("");
        line("def Xform {}", usd_text(root));
        block("{", "}", [&] {
            for (const auto& part : stage_.parts) {
                if (&part != &stage_.parts.front()) line("");
                if (part.fields) volume(part);
                else layer(part);
            }
        });
        return std::move(text_);
    }

private:
    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args) {
        const auto content = fmt::format(format, std::forward<Args>(args)...);
        if (!content.empty()) text_.append(4 * depth_, ' ');
        text_ += content + "\n";
    }

    void block(std::string_view begin, std::string_view end, const std::function<void()>& content) {
        line("{}", begin);
        ++depth_;
        content();
        --depth_;
        line("{}", end);
    }

    /// A file of a part as an asset.
    std::string asset(const UsdStage::Part& part, int frame) const {
        const auto from_here =
            full_path(part.file.at(frame)).lexically_relative(folder_).generic_string();
        // A path that does not begin with a dot would be looked for in other places, too.
        return usd_asset(from_here.starts_with("../") ? from_here : "./" + from_here);
    }

    void volume(const UsdStage::Part& part) {
        UsdNames names;
        std::vector<std::string> prims;
        for (const auto& field : part.fields->fields) prims.push_back(names.add(field.name));
        line("def Volume {}", usd_text(part.name));
        block("{", "}", [&] {
            for (const auto& prim : prims)
                line("rel field:{0} = </{1}/{2}/{0}>", prim, root, part.name);
            transform(part.fields->placement);
            for (std::size_t n = 0; n < prims.size(); ++n) {
                line("");
                field(part, part.fields->fields[n], prims[n]);
            }
        });
    }

    /// Operations from a file's space to the world; the last comes first.
    void transform(const Placement& placement) {
        std::string order;
        const auto& by = placement.translate;
        if (!by.isZero()) {
            line("double3 xformOp:translate = ({}, {}, {})", by.x(), by.y(), by.z());
            order = usd_text("xformOp:translate");
        }
        if (placement.scale != 1) {
            line("double3 xformOp:scale = ({0}, {0}, {0})", placement.scale);
            order += (order.empty() ? "" : ", ") + usd_text("xformOp:scale");
        }
        if (!order.empty()) line("uniform token[] xformOpOrder = [{}]", order);
    }

    void field(const UsdStage::Part& part, const UsdField& field, const std::string& prim) {
        line("def OpenVDBAsset {}", usd_text(prim));
        block("{", "}", [&] {
            line("token fieldClass = {}", usd_text(field.grid_class));
            line("token fieldDataType = {}", usd_text(field.data_type));
            line("int fieldIndex = {}", field.index);
            line("token fieldName = {}", usd_text(field.name));
            if (!part.file.per_frame()) {
                line("asset filePath = {}", asset(part, stage_.frames.front()));
            } else {
                block("asset filePath.timeSamples = {", "}", [&] {
                    for (const auto frame : stage_.frames)
                        line("{}: {},", frame, asset(part, frame));
                });
            }
            if (!field.role.empty()) line("token vectorDataRoleHint = {}", usd_text(field.role));
        });
    }

    void layer(const UsdStage::Part& part) {
        const auto typical = asset(part, stage_.frames[typical_place(stage_.frames.size())]);
        line("def {} (", usd_text(part.name));
        ++depth_;
        if (part.file.per_frame())
            block("clips = {", "}",
                  [&] { block("dictionary default = {", "}", [&] { clips(part, typical); }); });
        line("prepend references = {}", typical);
        --depth_;
        line(")");
        block("{", "}", [] {});
    }

    /// Value clips: each frame's own file, at the same time code. The manifest lists their
    /// attributes.
    void clips(const UsdStage::Part& part, const std::string& manifest) {
        std::string active, files;
        for (std::size_t n = 0; n < stage_.frames.size(); ++n) {
            const auto* const comma = n == 0 ? "" : ", ";
            active += fmt::format("{}({}, {})", comma, stage_.frames[n], n);
            files += comma + asset(part, stage_.frames[n]);
        }
        line("double2[] active = [{}]", active);
        line("asset[] assetPaths = [{}]", files);
        line("asset manifestAssetPath = {}", manifest);
        line("string primPath = {}", usd_text(fmt::format("/{}", usd_geometry)));
    }

    const UsdStage& stage_;
    fs::path folder_;
    std::string text_;
    std::size_t depth_ = 0;
};

}  // namespace

std::size_t typical_place(std::size_t frames) { return frames / 2; }

std::string stage_text(const UsdStage& stage, const std::string& path) {
    return StageWriter(stage, path).text();
}

}  // namespace fluidcarve
