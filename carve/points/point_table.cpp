#include "carve/points/point_table.h"

#include "carve/base/find_or_null.h"
#include "carve/base/saturated.h"

#include <cmath>
#include <cstring>

namespace fluidcarve {

const PointTable::Column* PointTable::column(std::string_view name) const {
    return find_or_null(columns, name, &Column::name);
}

double PointTable::number(const Column& column, std::size_t row) {
    return number_in(column.values.data() + row * bytes_of(column.type), column.type, false);
}

void PointTable::set(Column& column, std::size_t row, double number) {
    with_number_type(column.type, [&](auto value) {
        using T = decltype(value);
        if constexpr (std::is_floating_point_v<T>) value = static_cast<T>(number);
        else value = saturated<T>(std::round(number));
        std::memcpy(column.values.data() + row * sizeof value, &value, sizeof value);
    });
}

openvdb::Vec3d PointTable::position(std::size_t row) const {
    return {number(*column("x"), row), number(*column("y"), row), number(*column("z"), row)};
}

void PointTable::set_position(std::size_t row, const openvdb::Vec3d& to) {
    for (auto& each : columns)
        if (each.name.size() == 1 && each.name[0] >= 'x' && each.name[0] <= 'z')
            set(each, row, to[each.name[0] - 'x']);
}

std::size_t PointTable::bytes() const {
    std::size_t out = 0;
    for (const auto& column : columns) out += column.values.size();
    return out;
}

}  // namespace fluidcarve
