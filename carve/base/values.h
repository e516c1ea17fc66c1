#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

// Small types that the method and pipelines share.

namespace fluidcarve {

/// Shared data. It never changes after its creation: to edit it, make a copy.
template <class T>
using Ref = std::shared_ptr<const T>;

using Vec3 = std::array<double, 3>;

/// A value, or nothing for `auto`.
template <class T>
using Auto = std::optional<T>;

/// `[low, high]`, low <= high.
struct Interval {
    double low = 0;
    double high = 0;
};

/// A number of seams, or of the vertices by which an axis gets longer: a number, or a percentage of
/// the vertices along the axis. Negative removes, positive inserts. A number of seams is whole.
struct Count {
    double value = 0;
    bool percent = false;
    /// The count as a whole number. @param size  vertices along the carved axis
    int of(int size) const;
    /// The count without rounding. @param size  vertices that make 100 %
    double exactly(double size) const { return percent ? value / 100 * size : value; }
};
/// The count as a pipeline states it: "-12", "-2.5", "-30%".
std::string to_text(const Count& count);

/// Names of an enum's values, in pipelines and messages. Specialise it with
///   static constexpr std::array names = {std::pair{"linear", Interpolation::linear}, ...};
template <class E>
struct ChoiceNames;

/// The name of a value.
template <class E>
requires std::is_enum_v<E> std::string choice_text(E value) {
    for (const auto& [name, choice] : ChoiceNames<E>::names)
        if (choice == value) return name;
    return {};
}

}  // namespace fluidcarve
