#pragma once

#include "carve/volume/stored_form.h"
#include "formats/file/provenance.h"
#include "formats/geometry_file/ply.h"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

// OpenUSD's text files. Source: OpenUSD's schemas UsdGeom and UsdVol, and its page on value clips.

/// Name of the one prim in the .usda file of a mesh or of points.
inline constexpr std::string_view usd_geometry = "geometry";

/// Whether a text can name a prim or a property: ASCII letters, digits and `_`, no digit first.
bool is_usd_name(std::string_view text);

/// Turns texts into distinct names that are valid in USD: `vel.x` becomes `vel_x`, a second one
/// `vel_x_2`.
class UsdNames {
public:
    std::string add(std::string_view text);

private:
    std::set<std::string> taken_;
};

/// A text in quotes.
std::string usd_text(std::string_view text);
/// A path of another file: `@./a.vdb@`.
std::string usd_asset(std::string_view path);

/// A .usda file of one prim, a mesh or points.
class UsdGeometry {
public:
    /// An attribute that is an array.
    struct Array {
        std::string type;           ///< of an element: "point3f"
        std::string name;           ///< "primvars:st"
        std::string interpolation;  ///< empty: USD's own
        std::size_t parts = 1;      ///< numbers in an element
        NumberType number = NumberType::float32;
    };

    /// @param schema  "Mesh" or "Points"
    /// @param frame   the time that the arrays hold at; nothing: at all times
    UsdGeometry(std::string_view schema, std::optional<int> frame);

    /// @param statement  a line within the prim
    void add(std::string_view statement);
    /// @param array   with a name that is new in the prim
    /// @param values  `[element][part]`
    void add(const Array& array, const std::vector<double>& values);
    /// Adds an array as a primvar, an attribute without a meaning of its own in USD.
    /// @return false if USD has no type for elements of so many parts
    bool add_primvar(std::string_view name, std::string_view interpolation, std::size_t parts,
                     NumberType number, const std::vector<double>& values);
    /// Adds the positions of points or vertices, and their extent.
    /// @param placement  that of their reader, to be undone; null: none
    void add_positions(const std::vector<openvdb::Vec3d>& points, const Placement* placement);

    /// Whether there is an array of this name.
    bool has(const std::string& name) const { return names_.contains(name); }

    /// The whole file.
    std::string text() const { return text_ + "}\n"; }

private:
    std::optional<int> frame_;
    std::string text_;
    std::set<std::string> names_;  ///< of arrays
    UsdNames primvars_;
};

/// Writes a .usda file that appears whole or not at all. @throws Failure if it can't be written
/// @param text        of the whole file
/// @param provenance  goes behind its first line
void write_usda(const std::string& path, std::string_view text, const Provenance& provenance);

}  // namespace fluidcarve
