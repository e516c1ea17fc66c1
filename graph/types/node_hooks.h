#pragma once

namespace fluidcarve::detail {

/// Defines `has_NAME<Node>`: whether a node has a member of that name with any signature. It
/// derives from the node and from a class with such a member: if both have it, the name is
/// ambiguous.
#define FLUIDCARVE_HOOK(name)                      \
    struct Other_##name {                          \
        int name;                                  \
    };                                             \
    template <class Node>                          \
    struct Both_##name : Node, Other_##name {};    \
    template <class Node>                          \
    inline constexpr bool has_##name = !requires { \
        &Both_##name<Node>::name;                  \
    };
FLUIDCARVE_HOOK(run)
FLUIDCARVE_HOOK(add)
FLUIDCARVE_HOOK(digest)
FLUIDCARVE_HOOK(resume)
FLUIDCARVE_HOOK(traits)
FLUIDCARVE_HOOK(check)
FLUIDCARVE_HOOK(survey)
FLUIDCARVE_HOOK(foresee)
FLUIDCARVE_HOOK(conclude)
#undef FLUIDCARVE_HOOK

}  // namespace fluidcarve::detail
